//! What `straal completions` takes.

use clap::Args;
use clap_complete::Shell;

pub(super) const COMPLETIONS_ABOUT: &str = "\
Prints what a shell needs to complete straal's commands, options and their values when Tab is pressed. It goes where the \
shell looks for such files:

  bash        straal completions bash > ~/.local/share/bash-completion/completions/straal
  zsh         straal completions zsh > ~/.zfunc/_straal, with fpath+=~/.zfunc before compinit in ~/.zshrc
  fish        straal completions fish > ~/.config/fish/completions/straal.fish";

/// `straal completions`
#[derive(Debug, Args)]
pub struct CompletionsArgs {
    /// For which shell
    pub shell: Shell,
}
