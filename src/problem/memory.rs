//! The available memory.

use std::path::Path;

/// Memory that this process can still allocate \[bytes\]: limited by the machine and by the control
/// groups of the process. `None` if it is unknown.
pub fn available() -> Option<usize> {
    let machine = std::fs::read_to_string("/proc/meminfo").ok();
    let machine = machine.and_then(|text| of_machine(&text));
    let groups = std::fs::read_to_string("/proc/self/cgroup").unwrap_or_default();
    let groups = groups.lines().filter_map(of_group);
    machine.into_iter().chain(groups).min()
}

/// `MemAvailable` of /proc/meminfo \[bytes\].
fn of_machine(text: &str) -> Option<usize> {
    let line = text
        .lines()
        .find_map(|line| line.strip_prefix("MemAvailable:"))?;
    let kilobytes = line.trim().strip_suffix("kB")?.trim();
    kilobytes.parse::<usize>().ok()?.checked_mul(1024)
}

/// Memory left by a control group and those above it \[bytes\]; `line` is one of /proc/self/cgroup.
fn of_group(line: &str) -> Option<usize> {
    let mut parts = line.splitn(3, ':').skip(1);
    let (controllers, path) = (parts.next()?, parts.next()?);
    let (root, limit, usage) = match controllers {
        "" => ("/sys/fs/cgroup", "memory.max", "memory.current"),
        _ if controllers.split(',').any(|own| own == "memory") => (
            "/sys/fs/cgroup/memory",
            "memory.limit_in_bytes",
            "memory.usage_in_bytes",
        ),
        _ => return None,
    };
    let root = Path::new(root);
    let own = root.join(path.trim_start_matches('/'));
    let number = |path: &Path| {
        let text = std::fs::read_to_string(path).ok()?;
        text.trim().parse::<usize>().ok()
    };
    let left = |group: &Path| {
        let (limit, usage) = (number(&group.join(limit))?, number(&group.join(usage))?);
        Some(limit.saturating_sub(usage))
    };
    let groups = own.ancestors().take_while(|group| group.starts_with(root));
    groups.filter_map(left).min()
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn what_the_machine_says_is_read() {
        let text = "MemTotal: 9 kB\nMemAvailable:   2048 kB\nBuffers: 1 kB\n";
        assert_eq!(of_machine(text), Some(2 << 20));
        assert_eq!(of_machine("MemTotal: 9 kB\n"), None);
        assert_eq!(of_group("4:cpu,cpuacct:/x"), None);
    }
}
