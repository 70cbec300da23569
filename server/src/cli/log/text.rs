//! Events as lines of text.

use clap::builder::styling::{AnsiColor, Style};
use std::fmt;
use tracing::{Event, Level, Subscriber};
use tracing_subscriber::fmt::format::Writer;
use tracing_subscriber::fmt::time::{FormatTime as _, SystemTime};
use tracing_subscriber::fmt::{FmtContext, FormatEvent, FormatFields};
use tracing_subscriber::registry::LookupSpan;

/// Time, level, target, message and fields. Targets of the server are shortened: `net::session` for `prairie::net::session`.
pub(super) struct Text;

impl<S, N> FormatEvent<S, N> for Text
where
    S: Subscriber + for<'l> LookupSpan<'l>,
    N: for<'w> FormatFields<'w> + 'static,
{
    fn format_event(&self, context: &FmtContext<'_, S, N>, mut writer: Writer<'_>, event: &Event<'_>) -> fmt::Result {
        let is_coloured = writer.has_ansi_escapes();
        let styled = |style: Style| if is_coloured { style } else { Style::new() };
        let (level, dim) = (styled(style_of(event.metadata().level())), styled(Style::new().dimmed()));
        write!(writer, "{dim}")?;
        SystemTime.format_time(&mut writer)?;
        let target = short(event.metadata().target());
        write!(writer, "{dim:#} {level}{:>5}{level:#} {dim}{target}:{dim:#} ", event.metadata().level().as_str())?;
        context.field_format().format_fields(writer.by_ref(), event)?;
        writeln!(writer)
    }
}

/// The target without the name of the server's package.
fn short(target: &str) -> &str {
    target.strip_prefix("prairie::").unwrap_or(target)
}

fn style_of(level: &Level) -> Style {
    let colour = match *level {
        Level::ERROR => AnsiColor::Red,
        Level::WARN => AnsiColor::Yellow,
        Level::INFO => AnsiColor::Green,
        Level::DEBUG => AnsiColor::Blue,
        Level::TRACE => AnsiColor::Magenta,
    };
    colour.on_default()
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn targets_of_the_server_are_short_and_others_whole() {
        assert_eq!(
            [short("prairie::net::session"), short("hyper::proto"), short("prairie_wind::step")],
            ["net::session", "hyper::proto", "prairie_wind::step"]
        );
    }
}
