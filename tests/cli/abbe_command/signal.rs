//! Sends signals such as Ctrl-C from a test.

use std::process::{Child, Command};

/// Sends a signal by its name, such as `-INT`.
pub(crate) fn signal(child: &Child, name: &str) {
    let status = Command::new("kill").args([name, &child.id().to_string()]).status().expect("kill can be started");
    assert!(status.success());
}
