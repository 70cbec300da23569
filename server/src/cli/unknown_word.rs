//! The message about a word that is neither a command nor a scene.

use super::Cli;
use clap::CommandFactory as _;
use prairie::escaped::escaped;
use prairie::scenes::{SceneError, most_similar};

/// Adds the list of commands to an error about an unknown scene, since the word may be a misspelt command.
pub(super) fn suggest_commands(error: anyhow::Error) -> anyhow::Error {
    let Some(SceneError::Unknown { name, known, .. }) = error.downcast_ref::<SceneError>() else { return error };
    let prairie = Cli::command();
    let commands: Vec<_> = prairie.get_subcommands().map(clap::Command::get_name).collect();
    let meant = most_similar(name, known.iter().chain(&commands).copied());
    let suggestion = meant.map_or_else(|| ".".to_owned(), |word| format!("; did you mean `{word}`?"));
    anyhow::anyhow!(
        "there is no command, no built-in scene and no file called `{}`{suggestion} Commands: {}. Built-in scenes: {}",
        escaped(name),
        commands.join(", "),
        known.join(", ")
    )
}
