//! The program embeds packed copies of tables. They are up to date.

use flate2::Compression;
use flate2::read::{GzDecoder, GzEncoder};
use std::io::Read;
use std::path::{Path, PathBuf};

/// Returns the paths of all files in a folder and in its folders.
fn files(folder: &Path) -> Vec<PathBuf> {
    let entries = std::fs::read_dir(folder).expect("the folder is in the package");
    let paths = entries.map(|entry| entry.expect("the folder can be listed").path());
    paths.flat_map(|path| if path.is_dir() { files(&path) } else { vec![path] }).collect()
}

#[test]
fn packed_tables_are_up_to_date() {
    let data = Path::new(env!("CARGO_MANIFEST_DIR")).join("data");
    let all = files(&data);
    let copies: Vec<&PathBuf> = all.iter().filter(|path| path.starts_with(data.join("packed"))).collect();
    assert_eq!(copies.len(), 19);
    for copy in copies {
        let named = |path: &&PathBuf| path.file_name() == copy.file_stem();
        let [table] = all.iter().filter(named).collect::<Vec<_>>()[..] else { panic!("the table of {copy:?}") };
        let text = std::fs::read(table).unwrap();
        if std::env::var_os("ABBE_BLESS").is_some() {
            let mut packed = Vec::new();
            GzEncoder::new(&text[..], Compression::best()).read_to_end(&mut packed).unwrap();
            std::fs::write(copy, packed).unwrap();
        }
        let mut unpacked = Vec::new();
        GzDecoder::new(&std::fs::read(copy).unwrap()[..]).read_to_end(&mut unpacked).unwrap();
        assert!(
            unpacked == text,
            "{copy:?} is out of date; run: ABBE_BLESS=1 tests/run --test contracts packed, and build again"
        );
    }
}
