//! Parsing of the arguments, and the messages about wrong ones.

use super::print::is_closed_pipe;
use super::serve::Serve;
use super::{Cli, Command as Chosen};
use anyhow::Context as _;
use clap::error::{ContextKind, ContextValue, ErrorKind};
use clap::parser::ValueSource;
use clap::{ArgMatches, Command, CommandFactory as _, FromArgMatches as _};
use prairie::escaped::escaped;
use prairie::scenes::{self, most_similar};
use std::ffi::{OsStr, OsString};
use std::path::Path;
use std::process::ExitCode;

/// Parses the arguments of the program and its environment.
///
/// # Errors
/// clap's, for [`report`]; help and version are among them.
pub(super) fn parse() -> Result<Cli, clap::Error> {
    let mut command = without_empty_variables(Cli::command()).mut_subcommands(without_empty_variables);
    let arguments: Vec<OsString> = std::env::args_os().collect();
    let matches = command.try_get_matches_from_mut(&arguments).map_err(|error| explain(error, &mut command, &arguments))?;
    let mut cli = Cli::from_arg_matches(&matches)?;
    match (&mut cli.command, matches.subcommand_matches("serve")) {
        (None, _) => check(&mut cli.serve, &mut command, &matches)?,
        (Some(Chosen::Serve(serve)), Some(matches)) => check(serve, &mut command, matches)?,
        _ => {}
    }
    Ok(cli)
}

/// The command with arguments that do not ask for an environment variable that is empty: `${NAME:-}` in a Compose file sets one where none is meant.
fn without_empty_variables(command: Command) -> Command {
    let is_empty = |variable: &OsStr| std::env::var_os(variable).is_some_and(|value| value.is_empty());
    command.mut_args(|argument| if argument.get_env().is_some_and(is_empty) { argument.env(None::<&str>) } else { argument })
}

/// Checks the arguments of `serve` against each other, and notes which of them come from the environment.
fn check(serve: &mut Serve, command: &mut Command, matches: &ArgMatches) -> Result<(), clap::Error> {
    refuse_two_scenes(command, matches)?;
    let is_from_variable = |argument: &&clap::Arg| matches.value_source(argument.get_id().as_str()) == Some(ValueSource::EnvVariable);
    let from_variables: Vec<_> = command.get_arguments().filter(|argument| argument.get_env().is_some()).filter(is_from_variable).collect();
    let variable = |argument: &clap::Arg| argument.get_env().unwrap_or_default().to_string_lossy().into_owned();
    if let Some((id, needed)) = serve.tls.unmet() {
        let given = from_variables.iter().find(|argument| argument.get_id() == id);
        let name = given.map_or_else(|| format!("--{}", id.replace('_', "-")), |argument| variable(argument));
        return Err(command.error(ErrorKind::MissingRequiredArgument, format!("{name} needs {needed}")));
    }
    serve.variables = from_variables.into_iter().map(variable).collect();
    Ok(())
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

/// Rewrites three of clap's errors, which mistakes a second scene for a subcommand. The help names all environment variables, empty ones too.
fn explain(error: clap::Error, command: &mut Command, arguments: &[OsString]) -> clap::Error {
    if error.kind() == ErrorKind::DisplayHelp {
        return Cli::command().try_get_matches_from(arguments).err().unwrap_or(error);
    }
    match error.get(ContextKind::InvalidSubcommand) {
        Some(ContextValue::String(word)) if error.kind() == ErrorKind::ArgumentConflict && command.find_subcommand(word).is_none() => {
            let message = match misspelt_command(command, arguments, word) {
                Some((written, meant)) => format!("there is no command `{}`; did you mean `{meant}`?", escaped(written)),
                None => format!("`{}` is a second scene; allowed: one", escaped(word)),
            };
            command.error(ErrorKind::ArgumentConflict, message)
        }
        _ => name_variable(error, command, arguments),
    }
}

/// The word before the second one that resembles a command more than a built-in scene and is no file, and that command.
fn misspelt_command<'a>(command: &Command, arguments: &'a [OsString], second: &str) -> Option<(&'a OsString, String)> {
    let commands: Vec<_> = command.get_subcommands().map(Command::get_name).collect();
    let is_file =
        |word: &OsStr| Path::new(word).exists() || Path::new(word).extension().is_some() || Path::new(word).components().count() > 1;
    arguments.iter().skip(1).take_while(|word| *word != second).filter(|word| !is_file(word)).find_map(|word| {
        let meant = most_similar(word, scenes::list().map(|(name, _)| name).chain(commands.iter().copied()))?;
        commands.contains(&meant).then(|| (word, meant.to_owned()))
    })
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
