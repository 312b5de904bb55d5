//! Packs the phase functions of `data/media` for the program: in WebAssembly, the module of the
//! page in the browser is smaller by a fiftieth.
//!
//! Values of five digits are written as whole numbers that ascend with the value, and neighbours in
//! angle and wavelength differ little, so each number is stored less its prediction from the one
//! before, the one above, and the one between. `src/phase/packed_table.rs` reads the result.

use std::fs;
use std::path::Path;

/// The number of values of five digits in a decade.
const DECADE: i64 = 90_000;

fn main() {
    let out = std::env::var("OUT_DIR").expect("Cargo sets OUT_DIR");
    for name in ["ice", "rainbow"] {
        let source = format!("data/media/{name}.csv");
        println!("cargo::rerun-if-changed={source}");
        let text = fs::read_to_string(&source).unwrap_or_else(|error| panic!("{source}: {error}"));
        fs::write(Path::new(&out).join(name), packed(&text)).expect("OUT_DIR can be written");
    }
}

/// Returns the table with the header and the angles of the text, and packed values.
fn packed(text: &str) -> String {
    let mut lines = text.lines();
    let mut out = format!("{}\n", lines.next().expect("the table has a header"));
    let mut above: Vec<i64> = Vec::new();
    for line in lines {
        let (angle, values) = line.split_once(',').expect("a row has values");
        let row: Vec<i64> = values.split(',').map(ordinal).collect();
        out += angle;
        for (i, value) in row.iter().enumerate() {
            let left = if i > 0 { row[i - 1] - above.get(i - 1).unwrap_or(&0) } else { 0 };
            out += &format!(",{}", value - left - above.get(i).unwrap_or(&0));
        }
        out.push('\n');
        above = row;
    }
    out
}

/// Returns the ordinal of a positive number of at most five digits: that of m·10^e with
/// m from 10 000 to 99 999 is 90 000 e + m.
fn ordinal(text: &str) -> i64 {
    let value: f64 = text.parse().unwrap_or_else(|error| panic!("{text}: {error}"));
    let scientific = format!("{value:.4e}");
    assert_eq!(scientific.parse(), Ok(value), "{text} has more than five digits");
    let (digits, exponent) = scientific.split_once('e').expect("the number is in scientific notation");
    let digits: i64 = digits.replace('.', "").parse().expect("the digits are a number");
    let exponent: i64 = exponent.parse().expect("the exponent is a number");
    assert!(digits >= 10_000, "{text} is not positive");
    DECADE * (exponent - 4) + digits
}
