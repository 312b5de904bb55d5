//! `abbe man`: manual pages.

use std::path::{Path, PathBuf};

use clap::{Command, CommandFactory};
use clap_mangen::Man;

use super::{Cli, Outcome, print};
use abbe_spectra::error::{Error, Result};

#[derive(Debug, clap::Args)]
pub(crate) struct ManArgs {
    /// Print the page of this command instead of the page of the whole program
    #[arg(value_name = "COMMAND")]
    command: Option<String>,
    /// Write all pages into this folder: abbe.1, abbe-render.1, ...
    #[arg(short, long, value_name = "DIR", conflicts_with = "command")]
    output: Option<PathBuf>,
}

pub(crate) fn run(arguments: &ManArgs) -> Result<Outcome> {
    let mut root = Cli::command();
    match (&arguments.command, &arguments.output) {
        (_, Some(folder)) => write_all(root, folder)?,
        (None, None) => print::data(&page(root)?)?,
        (Some(name), None) => {
            // `build` gives the subcommands their full names, such as abbe-render.
            root.build();
            let names: Vec<String> = root.get_subcommands().map(|command| command.get_name().to_string()).collect();
            let known = root.get_subcommands().find(|command| command.get_name() == name);
            let known = known.ok_or_else(|| Error::unknown_name("command", name, names.iter().map(String::as_str)))?;
            print::data(&page(known.clone())?)?;
        }
    }
    Ok(Outcome::Done)
}

fn page(command: Command) -> Result<String> {
    let mut page = Vec::new();
    let written = Man::new(command).render(&mut page);
    written.map_err(|error| Error::machine(format!("the manual page cannot be written: {error}")))?;
    Ok(String::from_utf8_lossy(&page).into_owned())
}

fn write_all(root: Command, folder: &Path) -> Result<()> {
    let made = std::fs::create_dir_all(folder).and_then(|()| clap_mangen::generate_to(root, folder));
    made.map_err(|error| Error::machine(format!("the manual pages cannot be written: {error}")).in_file(folder))
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn every_command_has_a_manual_page() {
        let folder = tempfile::tempdir().unwrap();
        write_all(Cli::command(), folder.path()).unwrap();
        for command in Cli::command().get_subcommands() {
            let name = command.get_name();
            let page = std::fs::read_to_string(folder.path().join(format!("abbe-{name}.1"))).unwrap();
            assert!(page.contains(name), "{page}");
        }
        assert!(page(Cli::command()).unwrap().contains("abbe"));
    }
}
