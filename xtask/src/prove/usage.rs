//! Measures memory and processor time of each harness (proof), from the kernel's counts for the checker's tools and the solvers
//! that they start.
//!
//! A tool has the harness's file as an argument, which shows the harness of its process; a solver is recognised by its parent
//! process. Ten times a second the highest memory so far (`VmHWM`) and the processor time, including ended child processes, are
//! read. Both only grow, so at most the last tenth of a second is missed. Without `/proc` nothing is measured.

use std::collections::{HashMap, HashSet};
use std::path::Path;
use std::sync::Arc;
use std::sync::atomic::{AtomicBool, Ordering};
use std::thread::JoinHandle;
use std::time::Duration;

/// Memory and processor time of one harness (proof).
#[derive(Debug, Clone, Copy, Default, PartialEq)]
pub struct Usage {
    /// Highest total memory of all processes that ran for the harness (proof) at the same time, in KiB.
    pub memory_kib: u64,
    /// Processor time of all processes of the harness (proof) together, in seconds.
    pub processor_s: f64,
}

/// Memory and time of each process that was started for a harness (proof), including the processes that it started. The key is the
/// harness's file and the process id.
type Seen = HashMap<(String, u32), Usage>;

/// A thread that measures all processes that have a file below a given folder among their arguments.
pub struct Watch {
    stop: Arc<AtomicBool>,
    thread: JoinHandle<Seen>,
}

impl Watch {
    pub fn start(folder: &Path) -> Self {
        let stop = Arc::new(AtomicBool::new(false));
        let folder = folder.to_string_lossy().into_owned();
        let thread = std::thread::spawn({
            let stop = Arc::clone(&stop);
            move || {
                let mut seen = Seen::new();
                let mut kernels = HashSet::new();
                for looks in 0_u64.. {
                    if stop.load(Ordering::Relaxed) {
                        break;
                    }
                    // The kernel may give an old id to a new process, so the known ids are forgotten after 50 readings.
                    if looks % 50 == 0 {
                        kernels.clear();
                    }
                    look(&folder, &mut seen, &mut kernels);
                    std::thread::sleep(Duration::from_millis(100));
                }
                seen
            }
        });
        Self { stop, thread }
    }

    /// Stops measuring; returns memory and time of each harness (proof), by the name of the harness's file without its endings.
    pub fn finish(self) -> HashMap<String, Usage> {
        self.stop.store(true, Ordering::Relaxed);
        let mut sums = HashMap::<String, Usage>::new();
        for ((harness, _), usage) in self.thread.join().unwrap_or_default() {
            // The tools of a harness run one after the other: the highest memory counts, and the times are added.
            let sum = sums.entry(harness).or_default();
            sum.memory_kib = sum.memory_kib.max(usage.memory_kib);
            sum.processor_s += usage.processor_s;
        }
        sums
    }
}

/// What one reading of `/proc` says about a process: id of the parent process, and processor time in seconds.
struct Process {
    parent: u32,
    processor_s: f64,
}

/// Reads a process from its folder in `/proc`; `None` if the process has ended, or is one of the kernel's own, which have no
/// memory.
fn process(folder: &Path) -> Option<Process> {
    let stat = std::fs::read(folder.join("stat")).ok()?;
    let stat = String::from_utf8_lossy(&stat);
    // Field 2 is a name in brackets and may contain anything. Field 4 is the parent. Fields 14 to 17 are user and system time of
    // the process and of its ended children, in hundredths of a second on every Linux. Field 23 is the memory.
    let fields: Vec<&str> = stat.rsplit_once(')')?.1.split_whitespace().collect();
    let of = |field: usize| fields.get(field - 3)?.parse::<u64>().ok();
    let ticks: u64 = (14..=17).filter_map(of).sum();
    (of(23)? > 0).then_some(())?;
    Some(Process {
        parent: u32::try_from(of(4)?).ok()?,
        processor_s: ticks as f64 / 100.0,
    })
}

/// Highest memory of a process so far, in KiB.
fn memory_kib(folder: &Path) -> Option<u64> {
    let status = std::fs::read(folder.join("status")).ok()?;
    let status = String::from_utf8_lossy(&status);
    let line = status.lines().find_map(|it| it.strip_prefix("VmHWM:"))?;
    line.split_whitespace().next()?.parse().ok()
}

/// Reads all processes once and updates the values of each harness's (proof's) process together with its descendants. Ids of the
/// kernel's own processes are kept in `kernels`, so that these many processes are not read again.
fn look(folder: &str, seen: &mut Seen, kernels: &mut HashSet<u32>) {
    let mut all = HashMap::new();
    let mut of_harness = Vec::new();
    for entry in std::fs::read_dir("/proc").into_iter().flatten().flatten() {
        let name = entry.file_name();
        let Some(id) = name.to_str().and_then(|name| name.parse::<u32>().ok()) else {
            continue;
        };
        if kernels.contains(&id) {
            continue;
        }
        let Some(process) = process(&entry.path()) else {
            kernels.insert(id);
            continue;
        };
        all.insert(id, process);
        let arguments = std::fs::read(entry.path().join("cmdline")).unwrap_or_default();
        if let Some(harness) = harness(&arguments, folder) {
            of_harness.push((id, harness));
        }
    }
    for (id, harness) in of_harness {
        let below = |process: &u32| {
            let mut process = *process;
            // Follows the parents, at most 16, in case reused ids form a ring.
            for _ in 0..16 {
                if process == id {
                    return true;
                }
                match all.get(&process) {
                    Some(known) => process = known.parent,
                    None => return false,
                }
            }
            false
        };
        let mut sum = Usage::default();
        for (each, process) in all.iter().filter(|(process, _)| below(process)) {
            sum.memory_kib += memory_kib(&Path::new("/proc").join(each.to_string())).unwrap_or(0);
            sum.processor_s += process.processor_s;
        }
        let most = seen.entry((harness, id)).or_default();
        most.memory_kib = most.memory_kib.max(sum.memory_kib);
        most.processor_s = most.processor_s.max(sum.processor_s);
    }
}

/// Name of the harness's file among a process's arguments, without folder and endings. The files of harnesses (proofs) are those
/// with a mangled name (`__R`).
fn harness(arguments: &[u8], folder: &str) -> Option<String> {
    let arguments = String::from_utf8_lossy(arguments).into_owned();
    let file = arguments.split('\0').find(|argument| {
        argument.starts_with(folder) && argument.contains("__R") && argument.ends_with(".out")
    })?;
    let name = file.rsplit('/').next()?.split('.').next()?;
    Some(name.to_string())
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn a_process_tells_its_harness() {
        let line = b"cbmc\0--slice-formula\0/target/deps/proofs-1__RNvNt5proof.out\0";
        assert_eq!(
            harness(line, "/target").as_deref(),
            Some("proofs-1__RNvNt5proof")
        );
        assert_eq!(harness(line, "/elsewhere"), None);
        assert_eq!(
            harness(b"rustc\0/target/deps/proofs-1.rlib\0", "/target"),
            None
        );
    }

    /// Checks that a process with a harness's (proof's) file among its arguments is measured together with its child process.
    #[test]
    #[cfg(target_os = "linux")]
    fn a_running_process_is_measured() {
        let watch = Watch::start(Path::new("/measured"));
        let work =
            "sh -c 'i=0; while [ $i -lt 300000 ]; do i=$((i+1)); done; sleep 0.2'; sleep 0.2";
        let done = std::process::Command::new("sh")
            .args(["-c", work, "/measured/here__Rproof.out"])
            .status();
        assert!(done.expect("sh runs").success());
        let usage = watch.finish();
        assert_eq!(usage.len(), 1);
        let usage = usage["here__Rproof"];
        assert!(
            usage.memory_kib > 500 && usage.processor_s > 0.05,
            "{usage:?}"
        );
    }
}
