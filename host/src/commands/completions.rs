//! `kinesic completions`.

use clap::CommandFactory;
use clap_complete::Shell;

use super::{Cli, print};

/// Print a script that completes this command's words in a shell
#[derive(Debug, clap::Args)]
#[command(after_help = "\
Examples:
  kinesic completions bash > ~/.local/share/bash-completion/completions/kinesic
  kinesic completions zsh > ~/.zfunc/_kinesic
  kinesic completions fish > ~/.config/fish/completions/kinesic.fish")]
pub struct Args {
    /// The shell
    #[arg(value_name = "SHELL")]
    shell: Shell,
}

/// Runs the command.
pub fn run(args: &Args) -> miette::Result<()> {
    let mut script = Vec::new();
    clap_complete::generate(args.shell, &mut Cli::command(), "kinesic", &mut script);
    print::raw(&String::from_utf8_lossy(&script));
    Ok(())
}
