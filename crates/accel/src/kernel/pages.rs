//! Large pages of memory for large trees.

/// Vectors of fewer bytes aren't worth it.
#[cfg(target_os = "linux")]
const LARGE: usize = 8 << 20;

/// Asks the system to back what is still to be filled of a vector with large pages (2 MiB on x86-64, where nothing else is
/// set up). A ray through a large tree touches a few places in each of hundreds of megabytes: with pages of 4 KiB, the
/// processor looks up most of them in memory first. The system may ignore this, and nothing else changes.
pub(crate) fn want_large<T>(v: &mut Vec<T>) {
    #[cfg(target_os = "linux")]
    {
        let room = v.spare_capacity_mut();
        let bytes = size_of_val(room);
        if bytes < LARGE {
            return;
        }
        let start = room.as_mut_ptr().cast::<u8>();
        let skipped = start.align_offset(SMALL);
        if skipped < bytes {
            // SAFETY: `skipped` is less than the bytes of the room, which is the vector's own. Advice changes no content.
            unsafe {
                let start = start.add(skipped);
                libc::madvise(start.cast(), (bytes - skipped) / SMALL * SMALL, libc::MADV_HUGEPAGE);
            }
        }
    }
    #[cfg(not(target_os = "linux"))]
    let _ = v;
}

/// Advice is given for whole pages. Systems with larger ones refuse, which does no harm.
#[cfg(target_os = "linux")]
const SMALL: usize = 4096;

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn what_is_there_stays() {
        let mut v: Vec<u64> = (0..1000).collect();
        v.reserve_exact(4 << 20);
        want_large(&mut v);
        v.extend(1000..3_000_000);
        assert!(v.iter().enumerate().all(|(i, &x)| i as u64 == x));
    }
}
