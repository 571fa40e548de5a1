//! Memory and processor time of each harness: what the kernel counts for the checker and for the solvers that it starts.
//!
//! The checker's tools get the harness's file as an argument, so a process tells which harness it is for; a solver is known
//! by its parent. While they run, the kernel's own counts are read ten times a second: the highest memory so far (`VmHWM`)
//! and the processor time, of those that have ended as well. Both only grow, so that no more than what is added in the last
//! tenth of a second is missed. Without `/proc` nothing is measured.

use std::collections::{HashMap, HashSet};
use std::path::Path;
use std::sync::Arc;
use std::sync::atomic::{AtomicBool, Ordering};
use std::thread::JoinHandle;
use std::time::Duration;

/// Memory and time of one harness.
#[derive(Debug, Clone, Copy, Default, PartialEq)]
pub struct Usage {
    /// Highest memory of all its processes together.
    pub memory_kib: u64,
    /// Processor time of all its processes together.
    pub processor_s: f64,
}

/// Use of one process that was started for a harness, with all that it started.
type Seen = HashMap<(String, u32), Usage>;

/// Watches the processes that have files in one folder as arguments.
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
                    // A number is given again.
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

    /// The use of memory and time by the name of the harness's file, without its endings.
    pub fn finish(self) -> HashMap<String, Usage> {
        self.stop.store(true, Ordering::Relaxed);
        let mut sums = HashMap::<String, Usage>::new();
        for ((harness, _), usage) in self.thread.join().unwrap_or_default() {
            // The tools run one after the other.
            let sum = sums.entry(harness).or_default();
            sum.memory_kib = sum.memory_kib.max(usage.memory_kib);
            sum.processor_s += usage.processor_s;
        }
        sums
    }
}

/// A process at one look.
struct Process {
    parent: u32,
    processor_s: f64,
}

/// Reads one; `None` if it is gone, or the kernel's own, which has no memory.
fn process(folder: &Path) -> Option<Process> {
    let stat = std::fs::read(folder.join("stat")).ok()?;
    let stat = String::from_utf8_lossy(&stat);
    // The second field is a name in brackets and may hold anything. Parent, field 4; user and system time, own and of ended children,
    // are fields 14 to 17, in hundredths of a second on every Linux; memory, field 23.
    let fields: Vec<&str> = stat.rsplit_once(')')?.1.split_whitespace().collect();
    let of = |field: usize| fields.get(field - 3)?.parse::<u64>().ok();
    let ticks: u64 = (14..=17).filter_map(of).sum();
    (of(23)? > 0).then_some(())?;
    Some(Process {
        parent: u32::try_from(of(4)?).ok()?,
        processor_s: ticks as f64 / 100.0,
    })
}

/// A process' highest memory so far, KiB.
fn memory_kib(folder: &Path) -> Option<u64> {
    let status = std::fs::read(folder.join("status")).ok()?;
    let status = String::from_utf8_lossy(&status);
    let line = status.lines().find_map(|it| it.strip_prefix("VmHWM:"))?;
    line.split_whitespace().next()?.parse().ok()
}

/// Reads all processes once: those of a harness, together with all that they started. The kernel's own processes have
/// no memory, and are most of what there is to read, so each is read only once.
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
            // A chain of parents, cut off should the ids have been reused in a ring meanwhile.
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

/// The harness's file among the arguments, without folder and endings. Only files of harnesses have a mangled name in theirs.
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

    /// A child with such an argument is of a harness, and so is what it starts: half a second of work and some memory.
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
