//! The few wavelengths that one light path carries, and values at them.

/// How many wavelengths a path starts with. Four stratified wavelengths cost little more than one and take away
/// most colour noise where nothing disperses; eight add almost nothing.
pub const LANES: usize = 4;

/// One value per wavelength of a path; lanes at and beyond its count are 0.
pub type Lanes = [f64; LANES];

/// The wavelengths of a path: all of [`LANES`] at first, only the hero's after the first dispersive refraction.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct Wavelengths {
    /// Wavelengths in nm; the first `count` are in use.
    pub nm: Lanes,
    /// How many are in use, 1 to [`LANES`].
    pub count: usize,
}

impl Wavelengths {
    /// A path that carries all of these.
    pub fn new(nm: Lanes) -> Self {
        Self { nm, count: LANES }
    }

    /// A path at one wavelength.
    pub fn single(nm: f64) -> Self {
        let mut lanes = [0.0; LANES];
        lanes[0] = nm;
        Self { nm: lanes, count: 1 }
    }

    /// The wavelength that decides where the path goes.
    #[inline]
    pub fn hero(&self) -> f64 {
        self.nm[0]
    }

    /// The values of `f` at the wavelengths in use.
    #[inline]
    pub fn each(&self, mut f: impl FnMut(f64) -> f64) -> Lanes {
        let mut values = [0.0; LANES];
        self.active().iter().zip(&mut values).for_each(|(&nm, value)| *value = f(nm));
        values
    }

    /// The wavelengths in use.
    #[inline]
    pub fn active(&self) -> &[f64] {
        &self.nm[..self.count]
    }
}
