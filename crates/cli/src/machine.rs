//! How much memory there is, from Linux's `/proc` and `/sys/fs/cgroup`; elsewhere it isn't known, and nothing is refused.

use std::fs;
use std::path::Path;

/// Bytes that a render may take when `--memory` isn't said: what is free in the machine, in the control groups that this process is
/// in, and in its own address space, whichever is least, less a tenth.
pub fn memory() -> Option<u64> {
    let read = |path: &Path| fs::read_to_string(path).ok();
    free(&read).map(|bytes| bytes - bytes / 10)
}

/// Processors that this process may use.
pub fn processors() -> usize {
    std::thread::available_parallelism().map_or(1, usize::from)
}

/// What reads a file, so that tests can show others.
type Read<'a> = dyn Fn(&Path) -> Option<String> + 'a;

fn free(read: &Read<'_>) -> Option<u64> {
    let machine = read(Path::new("/proc/meminfo")).and_then(|text| kilobytes(&text, "MemAvailable:"));
    let groups = read(Path::new("/proc/self/cgroup")).map(|text| in_groups(&text, read)).unwrap_or_default();
    [machine, groups, in_address_space(read)].into_iter().flatten().min()
}

/// A line such as `MemAvailable:   123 kB` (proc(5)).
fn kilobytes(text: &str, key: &str) -> Option<u64> {
    let line = text.lines().find_map(|l| l.strip_prefix(key))?;
    let number: u64 = line.trim().strip_suffix("kB")?.trim().parse().ok()?;
    number.checked_mul(1024)
}

/// The least that is free in any control group of the process, of either version (cgroups(7)).
fn in_groups(groups: &str, read: &Read<'_>) -> Option<u64> {
    let mut least: Option<u64> = None;
    for line in groups.lines() {
        let mut fields = line.splitn(3, ':');
        let (Some(_), Some(controllers), Some(path)) = (fields.next(), fields.next(), fields.next()) else {
            continue;
        };
        let files = match controllers {
            "" => Files {
                root: "/sys/fs/cgroup",
                limit: "memory.max",
                used: "memory.current",
                idle: "inactive_file",
            },
            c if c.split(',').any(|c| c == "memory") => Files {
                root: "/sys/fs/cgroup/memory",
                limit: "memory.limit_in_bytes",
                used: "memory.usage_in_bytes",
                idle: "total_inactive_file",
            },
            _ => continue,
        };
        // A group is bound by those above it. In a container the path may be the host's, and the root is the group.
        let mut path = path.trim_matches('/');
        loop {
            let free = files.free(&Path::new(files.root).join(path), read);
            least = [least, free].into_iter().flatten().min();
            match path.rfind('/') {
                Some(end) => path = &path[..end],
                None if path.is_empty() => break,
                None => path = "",
            }
        }
    }
    least
}

/// Where a version of control groups tells of memory.
struct Files {
    root: &'static str,
    limit: &'static str,
    used: &'static str,
    /// The line of `memory.stat` with what is kept of files and given up when memory is needed.
    idle: &'static str,
}

impl Files {
    fn free(&self, group: &Path, read: &Read<'_>) -> Option<u64> {
        let number = |name: &str| read(&group.join(name))?.trim().parse::<u64>().ok();
        // `max` of version 2 is no number; version 1 has one near 2^63.
        let limit = number(self.limit)?;
        let idle = read(&group.join("memory.stat")).and_then(|text| {
            let line = text.lines().find_map(|l| l.strip_prefix(self.idle)?.strip_prefix(' '))?;
            line.trim().parse::<u64>().ok()
        });
        let used = number(self.used).unwrap_or(0).saturating_sub(idle.unwrap_or(0));
        Some(limit.saturating_sub(used))
    }
}

/// What is left of the limit that `ulimit -v` sets (getrlimit(2), `RLIMIT_AS`).
fn in_address_space(read: &Read<'_>) -> Option<u64> {
    let limits = read(Path::new("/proc/self/limits"))?;
    let line = limits.lines().find_map(|l| l.strip_prefix("Max address space"))?;
    let limit: u64 = line.split_whitespace().next()?.parse().ok()?;
    let used = read(Path::new("/proc/self/status")).and_then(|text| kilobytes(&text, "VmSize:"));
    Some(limit.saturating_sub(used.unwrap_or(0)))
}

#[cfg(test)]
mod tests {
    use super::*;

    /// Files by their paths.
    fn machine<'a>(files: &'a [(&'a str, &'a str)]) -> impl Fn(&Path) -> Option<String> + 'a {
        |path| files.iter().find(|(name, _)| Path::new(name) == path).map(|(_, text)| (*text).to_owned())
    }

    const MACHINE: (&str, &str) = ("/proc/meminfo", "MemTotal: 2000 kB\nMemAvailable:    1000 kB\n");

    #[test]
    fn the_least_counts() {
        assert_eq!(free(&machine(&[MACHINE])), Some(1_024_000));
        assert_eq!(free(&machine(&[])), None);
        let unlimited =
            ("/proc/self/limits", "Max address space         unlimited            unlimited  bytes\n");
        assert_eq!(free(&machine(&[MACHINE, unlimited])), Some(1_024_000));
        let limited =
            ("/proc/self/limits", "Max address space         900000               unlimited  bytes\n");
        let used = ("/proc/self/status", "VmSize:\t  100 kB\n");
        assert_eq!(free(&machine(&[MACHINE, limited, used])), Some(900_000 - 102_400));
    }

    #[test]
    fn groups_are_bound_by_those_above() {
        let files = [
            MACHINE,
            ("/proc/self/cgroup", "0::/a/b\n"),
            ("/sys/fs/cgroup/a/b/memory.max", "max\n"),
            ("/sys/fs/cgroup/a/memory.max", "500000\n"),
            ("/sys/fs/cgroup/a/memory.current", "300000\n"),
            ("/sys/fs/cgroup/a/memory.stat", "anon 1\ninactive_file 100000\n"),
        ];
        assert_eq!(free(&machine(&files)), Some(300_000));
    }

    #[test]
    fn the_first_version_is_understood() {
        let files = [
            MACHINE,
            ("/proc/self/cgroup", "12:cpu,cpuacct:/x\n4:memory:/job\n"),
            ("/sys/fs/cgroup/memory/job/memory.limit_in_bytes", "400000\n"),
            ("/sys/fs/cgroup/memory/job/memory.usage_in_bytes", "150000\n"),
            ("/sys/fs/cgroup/memory/memory.limit_in_bytes", "9223372036854771712\n"),
        ];
        assert_eq!(free(&machine(&files)), Some(250_000));
    }

    #[cfg(target_os = "linux")]
    #[test]
    fn this_machine_has_memory() {
        assert!(memory().is_some_and(|bytes| bytes > 0) && processors() > 0);
    }
}
