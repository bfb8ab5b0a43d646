//! Ctrl-C: the first ends the render after the present pass, the second ends the command.

use crate::complaint;
use crate::exit::{Exit, Failure};
use crate::out;
use crate::progress::Announcer;
use std::sync::atomic::{AtomicBool, Ordering};
use std::sync::{Arc, Mutex, MutexGuard, PoisonError, TryLockError};
use std::time::{Duration, Instant};

/// How long a second Ctrl-C waits for a picture that is being written, so that no half of it stays behind.
const PATIENCE: Duration = Duration::from_secs(5);

/// What the handler of Ctrl-C and the render share.
#[derive(Clone, Default)]
pub struct Interrupt {
    shared: Arc<Shared>,
}

#[derive(Default)]
struct Shared {
    asked: AtomicBool,
    /// Present while there is a render that can end early.
    announcer: Mutex<Option<Announcer>>,
    writing: Mutex<()>,
}

impl Interrupt {
    /// Listens to Ctrl-C from here on. Where that isn't possible, Ctrl-C does what the system does by itself.
    pub fn listen() -> Self {
        let this = Self::default();
        let handler = this.clone();
        // The only error is that there is a handler already, or that the system has no signals.
        let _ = ctrlc::set_handler(move || handler.press());
        this
    }

    /// From here on a picture can be had: the first Ctrl-C lets the present pass end.
    pub fn render_begins(&self, announcer: Announcer) {
        *self.shared.announcer.lock().unwrap_or_else(PoisonError::into_inner) = Some(announcer);
    }

    /// Whether Ctrl-C was pressed.
    pub fn is_asked(&self) -> bool {
        self.shared.asked.load(Ordering::SeqCst)
    }

    /// Runs what must not be cut in the middle.
    pub fn whole<R>(&self, f: impl FnOnce() -> R) -> R {
        let _guard = self.shared.writing.lock().unwrap_or_else(PoisonError::into_inner);
        f()
    }

    fn press(&self) {
        if let Some(announcer) = self.announcer()
            && !self.shared.asked.swap(true, Ordering::SeqCst)
        {
            announcer.say("ending after this pass; Ctrl-C again ends at once, without a picture");
            return;
        }
        // Held to the end, so that no writing begins while the command ends.
        let _guard = self.wait_for_writing();
        if let Some(announcer) = self.announcer() {
            announcer.say("ended by Ctrl-C");
        }
        let ended =
            Failure { exit: Exit::Interrupted, ..Failure::input("ended by Ctrl-C, without a picture") };
        out::last_words(|| complaint::failure_as_json(&ended));
        std::process::exit(i32::from(Exit::Interrupted.code()));
    }

    fn announcer(&self) -> Option<Announcer> {
        self.shared.announcer.lock().unwrap_or_else(PoisonError::into_inner).clone()
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
