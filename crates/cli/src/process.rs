//! What is known of the whole process from Linux's `/proc`: what it has cost so far, which signals it was started to ignore;
//! elsewhere it isn't known.

use std::fs;

/// Clock ticks in a second as `/proc` counts them. The kernel fixes this unit for its users (`USER_HZ`) at 100 on
/// every processor that Rust's standard library runs on.
const TICKS_PER_SECOND: f64 = 100.0;

/// Seconds of processor time, of the user's and the system's, of all threads together.
pub fn cpu_seconds() -> Option<f64> {
    cpu_of(&fs::read_to_string("/proc/self/stat").ok()?)
}

/// The most memory that was in use at any time.
pub fn peak_memory_bytes() -> Option<u64> {
    peak_of(&fs::read_to_string("/proc/self/status").ok()?)
}

/// Whether whoever started this process has it ignore a signal, as `nohup` does.
#[cfg(unix)]
pub fn ignores(signal: i32) -> bool {
    let status = fs::read_to_string("/proc/self/status").unwrap_or_default();
    ignored(&status).is_some_and(|mask| mask >> (signal - 1) & 1 == 1)
}

/// `SigIgn`, a bit for each signal.
#[cfg(unix)]
fn ignored(status: &str) -> Option<u64> {
    let line = status.lines().find_map(|l| l.strip_prefix("SigIgn:"))?;
    u64::from_str_radix(line.trim(), 16).ok()
}

/// Fields 14 and 15 of `/proc/PID/stat` (proc(5)). Field 2 is the name in parentheses and may hold anything.
fn cpu_of(stat: &str) -> Option<f64> {
    let (_, after_name) = stat.rsplit_once(')')?;
    let mut fields = after_name.split_whitespace().skip(11);
    let user: u64 = fields.next()?.parse().ok()?;
    let system: u64 = fields.next()?.parse().ok()?;
    Some((user + system) as f64 / TICKS_PER_SECOND)
}

/// `VmHWM`, in units of 1024 bytes.
fn peak_of(status: &str) -> Option<u64> {
    let line = status.lines().find_map(|l| l.strip_prefix("VmHWM:"))?;
    let kilobytes: u64 = line.trim().strip_suffix("kB")?.trim().parse().ok()?;
    Some(kilobytes * 1024)
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn fields_are_found_behind_any_name() {
        let stat = "42 (a) b) c) R 1 42 42 0 -1 4194304 100 0 0 0 250 50 7 8 20 0 3 0 100 1000 200";
        assert_eq!(cpu_of(stat), Some(3.0));
        assert_eq!(cpu_of(""), None);
        assert_eq!(cpu_of("42 (x) R 1"), None);
        assert_eq!(peak_of("Name:\tx\nVmPeak:\t  9 kB\nVmHWM:\t   2048 kB\n"), Some(2 << 20));
        assert_eq!(peak_of("Name:\tx\n"), None);
    }

    #[cfg(unix)]
    #[test]
    fn ignored_signals_are_bits() {
        assert_eq!(ignored("SigBlk:\t00\nSigIgn:\t0000000000001001\n"), Some(0x1001));
        assert_eq!(ignored(""), None);
    }

    #[cfg(target_os = "linux")]
    #[test]
    fn this_process_has_a_cost() {
        assert!(cpu_seconds().is_some());
        assert!(peak_memory_bytes().is_some_and(|bytes| bytes > 1 << 16));
    }
}
