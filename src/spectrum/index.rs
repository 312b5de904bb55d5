//! Finding, in constant time, the stretch of the band that a wavelength falls in.

use super::BAND_NM;

/// The most buckets an index uses; beyond it a bucket holds several stretches and is searched by bisection.
const MAX_BUCKETS: usize = 1 << 17;

/// How many stretches of one bucket are walked one by one before bisection is quicker.
const WALK: usize = 6;

/// Equal buckets over the band; each knows the first stretch that reaches into it (the guide table, or
/// cut-point, method: H.-C. Chen and Y. Asau, "On generating random variates from an empirical distribution",
/// AIIE Transactions 6, 1974).
#[derive(Debug, Clone, PartialEq)]
pub(crate) struct BandIndex {
    buckets_per_nm: f64,
    /// For each bucket the number of the stretch that holds its lower end; one more entry closes the list.
    first: Vec<u32>,
}

impl BandIndex {
    /// An index over stretches whose lower ends, in nm and in ascending order, are `lower`; the first stretch
    /// also answers for everything below its lower end.
    pub(crate) fn new(lower: impl ExactSizeIterator<Item = f64> + Clone) -> Self {
        let count = lower.len();
        let buckets = count.clamp(1, MAX_BUCKETS);
        let buckets_per_nm = buckets as f64 / (BAND_NM.1 - BAND_NM.0);
        let mut first = Vec::with_capacity(buckets + 1);
        let mut rest = lower.skip(1).peekable();
        let mut stretch = 0_u32;
        for bucket in 0..=buckets {
            // The slack keeps a wavelength that rounding puts into the next bucket from starting too far on.
            let edge = BAND_NM.0 + bucket as f64 / buckets_per_nm - 1e-9;
            while rest.next_if(|&lower| lower <= edge).is_some() {
                stretch += 1;
            }
            first.push(stretch);
        }
        if let Some(last) = first.last_mut() {
            *last = (count.max(1) - 1) as u32;
        }
        Self { buckets_per_nm, first }
    }

    /// The number of the last stretch whose lower end, given by `lower`, is ≤ `nm`; `nm` lies in the band.
    #[inline]
    pub(crate) fn find(&self, nm: f64, lower: impl Fn(usize) -> f64) -> usize {
        let buckets = self.first.len() - 1;
        let bucket = (((nm - BAND_NM.0) * self.buckets_per_nm) as usize).min(buckets - 1);
        let mut stretch = self.first[bucket] as usize;
        // Two buckets on, for the same rounding.
        let mut last = self.first[(bucket + 2).min(buckets)] as usize;
        if last - stretch <= WALK {
            while stretch < last && lower(stretch + 1) <= nm {
                stretch += 1;
            }
            return stretch;
        }
        while stretch < last {
            let middle = stretch + (last - stretch).div_ceil(2);
            if lower(middle) <= nm { stretch = middle } else { last = middle - 1 }
        }
        stretch
    }
}
