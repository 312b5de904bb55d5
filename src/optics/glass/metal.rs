//! Metals: `data/glass/metals.csv`, read once, at the first look-up.

use std::sync::LazyLock;

use super::dispersion::interpolate;
use crate::error::{Error, Result};

/// A metal's complex index n + ik at some wavelengths; linear between them, the end values are held outside.
#[derive(Debug, Clone, PartialEq)]
pub struct Metal {
    /// The chemical symbol.
    pub name: String,
    /// Wavelengths in nm, strictly increasing; they cover the band.
    pub nm: Vec<f64>,
    /// n at each.
    pub n: Vec<f64>,
    /// k at each.
    pub k: Vec<f64>,
}

impl Metal {
    /// n at a wavelength in nm.
    pub fn n(&self, wavelength_nm: f64) -> f64 {
        interpolate(&self.nm, &self.n, wavelength_nm)
    }

    /// k at a wavelength in nm.
    pub fn k(&self, wavelength_nm: f64) -> f64 {
        interpolate(&self.nm, &self.k, wavelength_nm)
    }
}

/// The names of all metals, in the file's order.
pub fn names() -> impl Iterator<Item = &'static str> {
    METALS.iter().map(|metal| metal.name.as_str())
}

/// The metal of this name, without regard to case. Fails on an unknown name, with the nearest known one.
pub fn find(name: &str) -> Result<&'static Metal> {
    let found = METALS.iter().find(|metal| metal.name.eq_ignore_ascii_case(name));
    found.ok_or_else(|| {
        let known: Vec<_> = names().collect();
        Error::unknown_name("metal", name, names()).expected(format!("one of {}", known.join(", ")))
    })
}

static METALS: LazyLock<Vec<Metal>> =
    LazyLock::new(|| read(include_str!("../../../data/glass/metals.csv")).expect("a test reads the embedded metals"));

/// Lines of `metal,wavelength_nm,n,k` under a header, a metal's lines together; `None` if one is malformed.
fn read(text: &str) -> Option<Vec<Metal>> {
    let mut metals: Vec<Metal> = Vec::new();
    for line in text.lines().skip(1) {
        let mut fields = line.split(',');
        let name = fields.next()?;
        let mut number = || fields.next()?.parse::<f64>().ok();
        let (nm, n, k) = (number()?, number()?, number()?);
        if metals.last().is_none_or(|metal| metal.name != name) {
            metals.push(Metal { name: name.to_string(), nm: Vec::new(), n: Vec::new(), k: Vec::new() });
        }
        let metal = metals.last_mut()?;
        metal.nm.push(nm);
        metal.n.push(n);
        metal.k.push(k);
    }
    Some(metals)
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::spectrum::BAND_NM;

    #[test]
    fn every_metal_covers_the_band_in_order() {
        let metals = read(include_str!("../../../data/glass/metals.csv")).unwrap();
        assert_eq!(metals.len(), 11);
        for metal in &metals {
            assert!(metal.nm.windows(2).all(|pair| pair[0] < pair[1]), "{}", metal.name);
            assert!(metal.nm[0] <= BAND_NM.0 && metal.nm[metal.nm.len() - 1] >= BAND_NM.1, "{}", metal.name);
            assert!(metal.n.iter().chain(&metal.k).all(|value| *value > 0.0), "{}", metal.name);
        }
    }

    #[test]
    fn metals_are_found_without_regard_to_case() {
        assert_eq!(find("au").unwrap().name, "Au");
        assert!(find("Unobtainium").unwrap_err().to_string().contains("one of Ag, Au, Cu"));
    }
}
