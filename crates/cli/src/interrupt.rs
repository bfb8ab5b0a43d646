//! Ctrl-C, and the signals by which a system or a scheduler ends a program: the first ends the render after the present
//! pass, the second ends the command.

use crate::complaint;
use crate::exit::{Exit, Failure};
use crate::out;
use crate::progress::Announcer;
use std::sync::atomic::{AtomicBool, Ordering};
use std::sync::{Arc, Mutex, MutexGuard, PoisonError, TryLockError};
use std::time::{Duration, Instant};
use straal_formats::atomic;

/// How long the end of the command waits for a picture that is being written, so that it is written whole.
const PATIENCE: Duration = Duration::from_secs(5);

/// `timeout` sends SIGTERM to a command and then to its group, and a terminal that is closed may hang up twice: what comes
/// so soon after the first is no second wish.
const ECHO: Duration = Duration::from_millis(10);

/// Who asks for an end.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
#[cfg_attr(not(unix), expect(dead_code, reason = "other systems have Ctrl-C only"))]
pub enum Cause {
    /// The person at the terminal: SIGINT.
    CtrlC,
    /// A scheduler, or the system that shuts down: SIGTERM.
    Terminate,
    /// The terminal that was closed: SIGHUP.
    HangUp,
    /// The limit of a file's size: SIGXFSZ.
    FileSize,
    /// The limit of processor time, each second until the hard limit kills: SIGXCPU.
    ProcessorTime,
}

impl Cause {
    /// How people call it.
    pub const fn name(self) -> &'static str {
        match self {
            Self::CtrlC => "Ctrl-C",
            Self::Terminate => "SIGTERM",
            Self::HangUp => "SIGHUP",
            Self::FileSize => "SIGXFSZ",
            Self::ProcessorTime => "SIGXCPU",
        }
    }
}

/// What the handler of signals and the render share.
#[derive(Clone, Default)]
pub struct Interrupt {
    shared: Arc<Shared>,
}

#[derive(Default)]
struct Shared {
    /// The first that asked for an end of the render, and when.
    asked: Mutex<Option<(Cause, Instant)>>,
    /// Present from when a render can end early.
    announcer: Mutex<Option<Announcer>>,
    /// Whether the render is over.
    over: AtomicBool,
    writing: Mutex<()>,
    /// Set while a write goes beyond the limit of a file's size.
    too_large: Arc<AtomicBool>,
}

fn locked<T>(mutex: &Mutex<T>) -> MutexGuard<'_, T> {
    mutex.lock().unwrap_or_else(PoisonError::into_inner)
}

impl Interrupt {
    /// Listens to signals from here on. Where that isn't possible, they do what the system does by itself.
    pub fn listen() -> Self {
        let this = Self::default();
        listen(this.clone());
        this
    }

    /// From here on a picture can be had: the first signal lets the present pass end.
    pub fn render_begins(&self, announcer: Announcer) {
        self.shared.over.store(false, Ordering::SeqCst);
        *locked(&self.shared.announcer) = Some(announcer);
    }

    /// From here on only what is written has to be waited for.
    pub fn render_ends(&self) {
        self.shared.over.store(true, Ordering::SeqCst);
    }

    /// Who asked for an end, if anyone did.
    pub fn asked(&self) -> Option<Cause> {
        locked(&self.shared.asked).map(|(cause, _)| cause)
    }

    /// Runs what must not be cut in the middle: it writes a file, and tells itself when that is too large.
    pub fn whole<R>(&self, f: impl FnOnce() -> R) -> R {
        let _guard = locked(&self.shared.writing);
        let done = f();
        self.shared.too_large.store(false, Ordering::SeqCst);
        done
    }

    /// What a signal does; each comes here in its turn, on a thread of its own.
    fn press(&self, cause: Cause) {
        if cause == Cause::FileSize && !self.is_asked_from_outside() {
            return;
        }
        if let Some(announcer) = self.announcer() {
            let first = {
                let mut asked = locked(&self.shared.asked);
                let first = asked.is_none();
                let (by, when) = *asked.get_or_insert((cause, Instant::now()));
                let is_echo = by == cause && cause != Cause::CtrlC && when.elapsed() < ECHO;
                if !first && (is_echo || cause == Cause::ProcessorTime) {
                    return;
                }
                first
            };
            if first {
                let what = if self.shared.over.load(Ordering::SeqCst) {
                    "the picture is being written"
                } else {
                    "ending after this pass"
                };
                announcer.say(&match cause {
                    Cause::CtrlC => format!("{what}; Ctrl-C again ends at once, without a picture"),
                    other => {
                        format!("{}: {what}; a second signal ends at once, without a picture", other.name())
                    }
                });
                return;
            }
        }
        // Held to the end, so that no writing begins while the command ends.
        let _guard = self.wait_for_writing();
        atomic::abandon();
        if let Some(announcer) = self.announcer() {
            announcer.say(&format!("ended by {}", cause.name()));
        }
        let told = format!("ended by {}, without a picture", cause.name());
        let ended = Failure { exit: Exit::Interrupted, ..Failure::input(told) };
        out::last_words(|| complaint::failure_as_json(&ended));
        std::process::exit(i32::from(Exit::Interrupted.code()));
    }

    /// Whether SIGXFSZ isn't the echo of a write of this command that failed, which is told where it is written.
    fn is_asked_from_outside(&self) -> bool {
        let _guard = self.wait_for_writing();
        self.shared.too_large.swap(false, Ordering::SeqCst) && self.announcer().is_some()
    }

    fn announcer(&self) -> Option<Announcer> {
        locked(&self.shared.announcer).clone()
    }

    fn wait_for_writing(&self) -> Option<MutexGuard<'_, ()>> {
        let until = Instant::now() + PATIENCE;
        loop {
            match self.shared.writing.try_lock() {
                Ok(guard) => return Some(guard),
                Err(TryLockError::WouldBlock) if Instant::now() < until => {
                    std::thread::sleep(Duration::from_millis(5));
                }
                Err(_) => return None,
            }
        }
    }
}

#[cfg(unix)]
fn listen(handler: Interrupt) {
    use signal_hook::consts::signal::{SIGHUP, SIGINT, SIGTERM, SIGXCPU, SIGXFSZ};
    use signal_hook::{flag, iterator::Signals};

    let mut signals = vec![SIGINT, SIGTERM, SIGXCPU, SIGXFSZ];
    // `nohup` has it ignored, and it stays so.
    if !crate::process::ignores(SIGHUP) {
        signals.push(SIGHUP);
    }
    // This one is set before the write that goes too far comes back; the thread below may come later.
    let flagged = flag::register(SIGXFSZ, handler.shared.too_large.clone());
    let Ok(mut signals) = flagged.and_then(|_| Signals::new(signals)) else { return };
    let wait = move || {
        for signal in signals.forever() {
            handler.press(match signal {
                SIGTERM => Cause::Terminate,
                SIGHUP => Cause::HangUp,
                SIGXFSZ => Cause::FileSize,
                SIGXCPU => Cause::ProcessorTime,
                _ => Cause::CtrlC,
            });
        }
    };
    // Without a thread signals would be lost: that a system has none left shows soon enough.
    let _ = std::thread::Builder::new().name("signals".into()).spawn(wait);
}

#[cfg(not(unix))]
fn listen(handler: Interrupt) {
    // The only error is that there is a handler already, or that the system has no signals.
    let _ = ctrlc::set_handler(move || handler.press(Cause::CtrlC));
}
