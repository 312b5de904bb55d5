//! The wavelengths of one light path, and the values at these wavelengths.

/// The number of wavelengths of a new path. Four stratified ones cost little more than one, and
/// remove most colour noise if no glass disperses the light; eight would improve little further.
pub const LANES: usize = 4;

/// One value for each wavelength of a path. Unused lanes are 0.
pub type Lanes = [f64; LANES];

/// The wavelengths of a path: only the hero remains after the first dispersive refraction.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct Wavelengths {
    /// Wavelengths in nm, of which the first `count` are in use.
    pub nm: Lanes,
    /// The number of wavelengths in use, from 1 to [`LANES`].
    pub count: usize,
}

impl Wavelengths {
    /// Returns the wavelengths of a new path, all of which are in use.
    pub fn new(nm: Lanes) -> Self {
        Self { nm, count: LANES }
    }

    /// Returns the wavelengths of a path with only one wavelength.
    pub fn single(nm: f64) -> Self {
        let mut lanes = [0.0; LANES];
        lanes[0] = nm;
        Self { nm: lanes, count: 1 }
    }

    /// Returns the hero wavelength, which decides the direction of the path.
    #[inline]
    pub fn hero(&self) -> f64 {
        self.nm[0]
    }

    /// Evaluates `f` at the wavelengths in use.
    #[inline]
    pub fn each(&self, mut f: impl FnMut(f64) -> f64) -> Lanes {
        let mut values = [0.0; LANES];
        self.active().iter().zip(&mut values).for_each(|(&nm, value)| *value = f(nm));
        values
    }

    /// Returns the wavelengths in use.
    #[inline]
    pub fn active(&self) -> &[f64] {
        &self.nm[..self.count]
    }
}
