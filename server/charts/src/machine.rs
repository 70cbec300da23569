//! Description of the machine that figures were measured on.

use std::hint::black_box;
use std::process::Command;
use std::time::Instant;

/// Machine and versions in one line, for captions: processor model and number of cores, system, compiler, package.
///
/// The compiler is the one on the `PATH`, which built this program under `cargo run`.
pub fn machine() -> String {
    let cores = std::thread::available_parallelism().map_or(1, usize::from);
    let system = format!("{} {}", std::env::consts::OS, std::env::consts::ARCH);
    let rustc = rustc_version().unwrap_or_else(|| "rustc of unknown version".into());
    let plural = if cores == 1 { "" } else { "s" };
    format!("{}, {cores} core{plural}, {system} · {rustc} · prairie {}", processor(), env!("CARGO_PKG_VERSION"))
}

/// The processor's name; on systems without `/proc/cpuinfo` its architecture.
pub fn processor() -> String {
    let info = std::fs::read_to_string("/proc/cpuinfo").unwrap_or_default();
    model_name(&info).unwrap_or(std::env::consts::ARCH).to_owned()
}

/// Shortest time (s) in which one core copies so many bytes from one buffer to another, again and again: of a state that fits into a cache, that of the cache.
pub fn copy_secs(bytes: usize) -> f64 {
    let (from, mut to) = (vec![1u8; bytes.max(1)], vec![0u8; bytes.max(1)]);
    // Long enough for a clock that counts nanoseconds.
    let copies = (1 << 20) / bytes.max(1) + 1;
    let timed = |_| {
        let begun = Instant::now();
        for _ in 0..copies {
            black_box(&mut to).copy_from_slice(black_box(&from));
        }
        begun.elapsed().as_secs_f64() / copies as f64
    };
    (0..7).map(timed).fold(f64::INFINITY, f64::min)
}

/// Memory of the machine (GiB); unknown on systems without `/proc/meminfo`.
pub fn memory_gib() -> Option<f64> {
    total_gib(&std::fs::read_to_string("/proc/meminfo").ok()?)
}

fn total_gib(meminfo: &str) -> Option<f64> {
    let kib = meminfo.lines().find_map(|line| line.strip_prefix("MemTotal:"))?.trim().strip_suffix(" kB")?;
    Some(kib.parse::<f64>().ok()? / f64::from(1 << 20))
}

fn model_name(cpuinfo: &str) -> Option<&str> {
    let line = cpuinfo.lines().find(|line| line.starts_with("model name"))?;
    line.split_once(':').map(|(_, name)| name.trim())
}

/// `rustc 1.95.0`, without commit and date.
pub fn rustc_version() -> Option<String> {
    let output = Command::new("rustc").arg("--version").output().ok()?;
    let text = String::from_utf8(output.stdout).ok()?;
    let words: Vec<&str> = text.split_whitespace().take(2).collect();
    (words.len() == 2).then(|| words.join(" "))
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn the_processor_has_a_name() {
        let cpuinfo = "processor\t: 0\nvendor_id\t: Made\nmodel name\t: Made-up 9000 @ 1 GHz\nstepping\t: 1\n";
        assert_eq!(model_name(cpuinfo), Some("Made-up 9000 @ 1 GHz"));
        assert_eq!(model_name("processor\t: 0\n"), None);
    }

    #[test]
    fn the_memory_is_that_of_the_machine() {
        assert_eq!(total_gib("MemTotal:        2097152 kB\nMemFree:  1 kB\n"), Some(2.0));
        assert_eq!(total_gib("MemFree:  1 kB\n"), None);
    }

    #[test]
    fn the_caption_names_cores_and_versions() {
        let caption = machine();
        assert!(caption.contains(" core") && caption.contains("rustc ") && caption.contains("prairie "), "{caption}");
    }
}
