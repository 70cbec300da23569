//! Parsing of the arguments, and the messages about wrong ones.

use super::Cli;
use super::print::is_closed_pipe;
use anyhow::Context as _;
use clap::error::{ContextKind, ContextValue, ErrorKind};
use clap::parser::ValueSource;
use clap::{ArgMatches, Command, CommandFactory as _, FromArgMatches as _};
use prairie::escaped::escaped;
use std::ffi::OsString;
use std::process::ExitCode;

/// Parses the arguments of the program and its environment.
///
/// # Errors
/// clap's, for [`report`]; help and version are among them.
pub(super) fn parse() -> Result<Cli, clap::Error> {
    let mut command = Cli::command();
    let arguments: Vec<OsString> = std::env::args_os().collect();
    let matches = command.try_get_matches_from_mut(&arguments).map_err(|error| explain(error, &mut command, &arguments))?;
    for matches in [Some(&matches), matches.subcommand_matches("serve")].into_iter().flatten() {
        refuse_two_scenes(&mut command, matches)?;
    }
    Cli::from_arg_matches(&matches)
}

/// Prints clap's output: help and version to stdout (status 0), usage errors to stderr (status 2).
///
/// # Errors
/// When stdout cannot be written.
pub(super) fn report(error: &clap::Error) -> anyhow::Result<ExitCode> {
    match error.print() {
        Err(reason) if !error.use_stderr() && !is_closed_pipe(&reason) => Err(reason).context("cannot write to stdout"),
        _ => Ok(ExitCode::from(u8::try_from(error.exit_code()).unwrap_or(2))),
    }
}

/// Rejects a scene given twice on the command line. clap's own check would also reject a word beside `PRAIRIE_SCENE`, which is allowed.
fn refuse_two_scenes(command: &mut Command, matches: &ArgMatches) -> Result<(), clap::Error> {
    let has_word = matches!(matches.try_contains_id("scene"), Ok(true));
    let has_flag =
        matches!(matches.try_contains_id("scene_flag"), Ok(true)) && matches.value_source("scene_flag") == Some(ValueSource::CommandLine);
    if has_word && has_flag {
        return Err(command.error(ErrorKind::ArgumentConflict, "the scene is given twice, as a word and by --scene; give it once"));
    }
    Ok(())
}

/// Rewrites clap's error for a second scene, which clap mistakes for a subcommand.
fn explain(error: clap::Error, command: &mut Command, arguments: &[OsString]) -> clap::Error {
    match error.get(ContextKind::InvalidSubcommand) {
        Some(ContextValue::String(word)) if error.kind() == ErrorKind::ArgumentConflict && command.find_subcommand(word).is_none() => {
            let message = format!("`{}` is a second scene; allowed: one", escaped(word));
            command.error(ErrorKind::ArgumentConflict, message)
        }
        _ => name_variable(error, command, arguments),
    }
}

/// Adds the name of the environment variable to the message about an invalid value that came from there.
fn name_variable(mut error: clap::Error, command: &Command, arguments: &[OsString]) -> clap::Error {
    let Some(ContextValue::String(argument)) = error.get(ContextKind::InvalidArg) else { return error };
    let flag = argument.split([' ', '=']).next().unwrap_or_default().to_owned();
    let is_on_the_line = arguments.iter().filter_map(|word| word.to_str()).any(|word| word.split('=').next() == Some(flag.as_str()));
    let long = |argument: &&clap::Arg| argument.get_long().is_some_and(|long| flag == format!("--{long}"));
    let variable = command.get_arguments().find(long).and_then(clap::Arg::get_env);
    if let Some(variable) = variable.filter(|_| !is_on_the_line) {
        let note = format!("the value comes from the environment variable {}", variable.to_string_lossy());
        error.insert(ContextKind::Suggested, ContextValue::StyledStrs(vec![note.into()]));
    }
    error
}
