//! Files of the package that `tests/bless` generates.

use std::path::Path;

/// Compares a generated file of the package with its new text. With `ABBE_BLESS`, the file is
/// written instead.
///
/// # Panics
/// Panics at the first line that differs.
pub(crate) fn is_up_to_date(path: &str, generated: &str) {
    let file = Path::new(env!("CARGO_MANIFEST_DIR")).join(path);
    if std::env::var_os("ABBE_BLESS").is_some() {
        std::fs::write(&file, generated).expect("the file can be written");
    }
    let kept = std::fs::read_to_string(&file).unwrap_or_default();
    for (kept, generated) in kept.lines().zip(generated.lines()) {
        assert_eq!(kept, generated, "{path} is out of date; run: tests/bless");
    }
    assert!(kept == generated, "{path} is out of date; run: tests/bless");
}
