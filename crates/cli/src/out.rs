//! The only place that writes to standard output and standard error.

use serde_json::Value as Json;
use std::ffi::OsStr;
use std::io::{self, ErrorKind, IsTerminal, Write};
use std::sync::atomic::{AtomicBool, Ordering};

/// Whether a script waits for one JSON object that it hasn't got: what ends the command early, on whichever thread, owes it one.
static OWES_JSON: AtomicBool = AtomicBool::new(false);

/// Says whether the command was asked for JSON.
pub fn answers_in_json(asked: bool) {
    OWES_JSON.store(asked, Ordering::SeqCst);
}

/// What a script is told when the command ends without a result; nothing when it wasn't asked for, or was told already.
pub fn last_words(object: impl FnOnce() -> Json) {
    if OWES_JSON.load(Ordering::SeqCst)
        && let Err(e) = result(&format!("{:#}\n", object()))
    {
        say(&format!("error: can't write to standard output: {e}\n"));
    }
}

/// Writes a result to standard output. That nobody listens any more, as when `head` has seen enough, is no error.
pub fn result(text: &str) -> io::Result<()> {
    OWES_JSON.store(false, Ordering::SeqCst);
    let mut out = io::stdout().lock();
    match out.write_all(text.as_bytes()).and_then(|()| out.flush()) {
        Err(e) if e.kind() == ErrorKind::BrokenPipe => Ok(()),
        done => done,
    }
}

/// Writes a picture to standard output, on which nothing else may come then. That nobody listens any more is no error.
pub fn picture(write: impl FnOnce(&mut dyn Write) -> io::Result<()>) -> io::Result<()> {
    let mut out = io::BufWriter::with_capacity(1 << 16, io::stdout().lock());
    match write(&mut out).and_then(|()| out.flush()) {
        Err(e) if e.kind() == ErrorKind::BrokenPipe => Ok(()),
        done => done,
    }
}

/// Says something to the person on standard error. When that can't be written there is nobody to tell.
pub fn say(text: &str) {
    let mut err = io::stderr().lock();
    let _ = err.write_all(text.as_bytes()).and_then(|()| err.flush());
}

/// Whether a person watches standard error.
pub fn is_watched() -> bool {
    io::stderr().is_terminal() && std::env::var_os("TERM").is_none_or(|term| term != "dumb")
}

/// Whether what is said to the person may have colours.
pub fn has_colours() -> bool {
    colours(is_watched(), std::env::var_os("NO_COLOR").as_deref())
}

/// On a terminal, unless NO_COLOR is set to something (no-color.org).
fn colours(watched: bool, no_color: Option<&OsStr>) -> bool {
    watched && no_color.is_none_or(OsStr::is_empty)
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn colours_are_for_terminals() {
        assert!(colours(true, None));
        assert!(colours(true, Some(OsStr::new(""))));
        assert!(!colours(true, Some(OsStr::new("1"))));
        assert!(!colours(false, None));
    }
}
