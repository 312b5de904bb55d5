//! The crystals of the catalogue.

use super::indices::UniaxialIndices;
use abbe_optics::RefractiveIndex;
use abbe_optics::glass::catalogue;
use abbe_spectra::error::{Error, Result};
use abbe_spectra::spectrum::BAND_NM;

/// The birefringence of ice at all visible wavelengths (Hobbs 1974, *Ice Physics*).
const ICE_BIREFRINGENCE: f64 = 0.0014;

/// The wavelengths of the indices that differ from their entries by a number, from the start of the
/// band on.
const TABLE_STEPS: u32 = 47;
const TABLE_STEP_NM: f64 = 10.0;

/// The names of the crystals and of their entries in `data/glass/glasses.json`, for o and e. Ice
/// has one entry for both.
const ENTRIES: [(&str, [&str; 2]); 6] = [
    ("calcite", ["calcite (o)", "calcite (e)"]),
    ("quartz", ["crystal quartz (o)", "crystal quartz (e)"]),
    ("MgF2", ["MgF2 (o)", "MgF2 (e)"]),
    ("sapphire", ["sapphire (o)", "sapphire (e)"]),
    ("rutile", ["rutile TiO2 (o)", "rutile TiO2 (e)"]),
    ("ice", ["ice -7C", "ice -7C"]),
];

/// The names that [`Crystal::find`] knows.
pub const CRYSTAL_NAMES: [&str; 6] = {
    let mut names = [""; 6];
    let mut i = 0;
    while i < names.len() {
        names[i] = ENTRIES[i].0;
        i += 1;
    }
    names
};

/// A uniaxial crystal: of the catalogue, or with other indices.
#[derive(Debug, Clone, PartialEq)]
pub struct Crystal {
    /// The name, such as `calcite`.
    pub name: String,
    ordinary: RefractiveIndex,
    extraordinary: RefractiveIndex,
    /// Numbers that are added to both indices.
    shifts: [f64; 2],
    /// The source of the data.
    pub source: String,
}

impl Crystal {
    /// Creates a crystal from its two indices, such as those of two files of refractiveindex.info.
    pub fn new(name: &str, ordinary: RefractiveIndex, extraordinary: RefractiveIndex, source: &str) -> Self {
        Self { name: name.to_string(), ordinary, extraordinary, shifts: [0.0; 2], source: source.to_string() }
    }

    /// Returns the crystal with a name of [`CRYSTAL_NAMES`], in any case, or an error that suggests
    /// a similar name.
    pub fn find(name: &str) -> Result<Self> {
        let entry = ENTRIES.iter().find(|(known, _)| known.eq_ignore_ascii_case(name));
        let &(name, [o, e]) = entry.ok_or_else(|| {
            Error::unknown_name("crystal", name, CRYSTAL_NAMES).expected("a uniaxial crystal of the catalogue")
        })?;
        let (ordinary, extraordinary) = (catalogue::find(o)?, catalogue::find(e)?);
        let mut source = ordinary.source.replace("-o.yml", "-o.yml and -e.yml");
        // The table of ice is for ice of random orientation: it is the mean of two ordinary axes
        // and an extraordinary one.
        let shifts = if o == e { [-ICE_BIREFRINGENCE / 3.0, 2.0 * ICE_BIREFRINGENCE / 3.0] } else { [0.0; 2] };
        if o == e {
            source += &format!(
                "; its n is taken as (2 n_o + n_e)/3, with n_e − n_o = {ICE_BIREFRINGENCE} at all wavelengths from \
                 P. V. Hobbs, Ice Physics, Oxford 1974"
            );
        }
        let (ordinary, extraordinary) = (ordinary.index.clone(), extraordinary.index.clone());
        Ok(Self { shifts, ..Self::new(name, ordinary, extraordinary, &source) })
    }

    /// Returns the indices at a wavelength in nm. Beyond [`range_nm`](Self::range_nm), they are
    /// those at its ends.
    pub fn at(&self, nm: f64) -> UniaxialIndices {
        UniaxialIndices {
            ordinary: self.ordinary.n(nm) + self.shifts[0],
            extraordinary: self.extraordinary.n(nm) + self.shifts[1],
        }
    }

    /// Returns the ordinary and the extraordinary index.
    pub fn indices(&self) -> Result<[RefractiveIndex; 2]> {
        let shifted = |index: &RefractiveIndex, shift: f64| {
            if shift == 0.0 {
                return Ok(index.clone());
            }
            let nm: Vec<f64> = (0..=TABLE_STEPS).map(|i| BAND_NM.0 + f64::from(i) * TABLE_STEP_NM).collect();
            RefractiveIndex::table(&nm, &nm.iter().map(|&nm| index.n(nm) + shift).collect::<Vec<_>>())
        };
        Ok([shifted(&self.ordinary, self.shifts[0])?, shifted(&self.extraordinary, self.shifts[1])?])
    }

    /// Returns the wavelengths in nm between which both indices are valid.
    pub fn range_nm(&self) -> (f64, f64) {
        let (o, e) = (self.ordinary.range_nm(), self.extraordinary.range_nm());
        (o.0.max(e.0), o.1.min(e.1))
    }

    /// Returns the restriction of the data, such as wavelengths of the band without data.
    pub fn warning(&self) -> Option<&str> {
        self.ordinary.warning().or(self.extraordinary.warning())
    }

    /// Returns the optical path difference d·|n_e − n_o| in nm of a plate with the axis in its
    /// surface, at a wavelength in nm. The thickness is in nm.
    pub fn path_difference_nm(&self, thickness_nm: f64, nm: f64) -> f64 {
        thickness_nm * self.at(nm).birefringence().abs()
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn each_crystal_has_its_published_birefringence() {
        // Rounded values at 589 nm of textbooks: Hecht, Optics, table 8.1, and Born & Wolf.
        let known = [-0.172, 0.0091, 0.0118, -0.008, 0.287, 0.0014];
        for (name, known) in CRYSTAL_NAMES.into_iter().zip(known) {
            let found = Crystal::find(&name.to_uppercase()).unwrap().at(589.2938).birefringence();
            assert!((found - known).abs() < 0.04 * f64::abs(known), "{name}: {found}");
        }
        let ice = Crystal::find("ice").unwrap().at(590.0);
        assert!((ice.ordinary - 1.3092).abs() < 1e-4 && (ice.extraordinary - 1.3106).abs() < 1e-4, "{ice:?}");
    }

    #[test]
    fn an_unknown_crystal_brings_the_nearest_name() {
        let message = Crystal::find("calcit").unwrap_err().to_string();
        assert!(message.contains("unknown crystal") && message.contains("calcite"), "{message}");
    }
}
