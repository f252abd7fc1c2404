//! Large pages of memory.
//!
//! What a step of a simulation touches lies scattered over some megabytes, for which a processor looks up hundreds of
//! pages of 4 kB, over and over. Linux gives pages of 2 MB, but on many systems only to programs that ask for them, which
//! the allocator of the GNU C library does when a variable tells it to, at the start of a program. So the
//! program sets that variable and starts itself anew, in its place: same process, same arguments. Measured figures:
//! docs/performance.md. Whoever has set the variable, be it to nothing, is left alone.

/// Read by the GNU C library at the start of a program.
#[cfg(all(target_os = "linux", target_env = "gnu"))]
const VARIABLE: &str = "GLIBC_TUNABLES";

/// Ask for large pages. Blocks of less than 2 MiB lie side by side in heaps that are kept, so that small ones
/// share pages; larger ones have some of their own, which go back to the system. Heaps grow by 16 MiB, since those of threads would
/// else grow by too little at a time for a page, and by no more, since blocks of any size go where a heap has room.
#[cfg(all(target_os = "linux", target_env = "gnu"))]
const TUNABLES: &str = "glibc.malloc.hugetlb=1:glibc.malloc.mmap_threshold=2097152:\
                        glibc.malloc.trim_threshold=1073741824:glibc.malloc.top_pad=16777216";

/// Start the program anew with large pages, where there are any and nobody has said otherwise.
#[cfg(all(target_os = "linux", target_env = "gnu"))]
pub(crate) fn ask_for_large_ones() {
    use std::os::unix::process::CommandExt;
    let given = std::fs::read_to_string("/sys/kernel/mm/transparent_hugepage/enabled");
    if std::env::var_os(VARIABLE).is_some() || !given.is_ok_and(|how| offered(&how)) {
        return;
    }
    let mut own = std::env::args_os();
    if let Some(name) = own.next() {
        // The kernel's link leads to the very program that runs, even if a build has put another one in its place.
        let mut again = std::process::Command::new("/proc/self/exe");
        // This comes back only if it fails; then the program goes on as it is.
        let _ = again.arg0(name).args(own).env(VARIABLE, TUNABLES).exec();
    }
}

/// Elsewhere nothing is asked for.
#[cfg(not(all(target_os = "linux", target_env = "gnu")))]
pub(crate) fn ask_for_large_ones() {}

/// Whether the system gives large pages, by its own words: `always [madvise] never`, the one in force in brackets.
#[cfg(all(target_os = "linux", target_env = "gnu"))]
fn offered(how: &str) -> bool {
    ["[always]", "[madvise]"].iter().any(|word| how.contains(word))
}

#[cfg(all(test, target_os = "linux", target_env = "gnu"))]
mod tests {
    #[test]
    fn large_pages_are_asked_for_where_the_system_gives_them() {
        assert!(super::offered("always [madvise] never\n"));
        assert!(super::offered("[always] madvise never\n"));
        assert!(!super::offered("always madvise [never]\n"));
        assert!(!super::offered(""));
    }
}
