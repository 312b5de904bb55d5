//! Tables of other programs, which are 0 beyond their ends.

use serde_json::{Value, json};

/// The wavelengths (nm) that pbrt and Mitsuba simulate.
const VISIBLE_NM: [f64; 2] = [360.0, 830.0];

/// Returns the table of a reflectance or of a coefficient. In pbrt and in Mitsuba, it is 0 beyond
/// its ends, and in a scene file, it is constant there.
pub(super) fn dark_outside(nm: &[f64], values: &[f64]) -> Value {
    /// The distance (nm) from the end of a table to the first wavelength with the value 0.
    const EDGE_NM: f64 = 0.01;
    let (mut nm, mut values) = (nm.to_vec(), values.to_vec());
    if nm.first().is_some_and(|&first| first > VISIBLE_NM[0]) {
        nm.insert(0, nm[0] - EDGE_NM);
        values.insert(0, 0.0);
    }
    if let Some(&last) = nm.last()
        && last < VISIBLE_NM[1]
    {
        nm.push(last + EDGE_NM);
        values.push(0.0);
    }
    json!({"table": {"nm": nm, "values": values}})
}
