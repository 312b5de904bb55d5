//! Deflates the large tables of `data/` for embedding. They would be a thirtieth of the program.

use flate2::{Compression, write::ZlibEncoder};
use std::error::Error;
use std::io::Write;
use std::path::Path;

/// The tables, as paths inside `data/`. The program embeds smaller files as they are.
const TABLES: [&str; 3] = ["glass/glasses.json", "media/rainbow.csv", "microfacets/missing_energy.csv"];

fn main() -> Result<(), Box<dyn Error>> {
    let folder = std::env::var("OUT_DIR")?;
    for table in TABLES {
        let path = Path::new("data").join(table);
        println!("cargo::rerun-if-changed={}", path.display());
        let mut encoder = ZlibEncoder::new(Vec::new(), Compression::best());
        encoder.write_all(&std::fs::read(&path)?)?;
        let name = path.file_name().ok_or("a table without a file name")?;
        std::fs::write(Path::new(&folder).join(name).with_added_extension("z"), encoder.finish()?)?;
    }
    Ok(())
}
