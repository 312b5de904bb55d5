//! Constant-time search for the segment of the band that contains a wavelength.

use super::band::BAND_NM;

/// The largest number of buckets of an index. With more segments than buckets, some buckets contain
/// several segments, and one with many is searched by bisection.
const MAX_BUCKETS: usize = 1 << 17;

/// The largest number of segments of a bucket for which linear search beats bisection.
const MAX_LINEAR_SEARCH: usize = 6;

/// Buckets of equal width over the band, each with the first segment that reaches into it (the
/// guide table or cut-point method: H.-C. Chen and Y. Asau, "On generating random variates from an
/// empirical distribution", AIIE Transactions 6, 1974).
#[derive(Debug, Clone, PartialEq)]
pub(crate) struct BandIndex {
    buckets_per_nm: f64,
    /// The segment that contains the lower end of each bucket, and one extra entry.
    first: Vec<u32>,
}

impl BandIndex {
    /// Builds an index from ascending lower ends in nm. The first segment also takes what is below.
    pub(crate) fn new(lower: impl ExactSizeIterator<Item = f64> + Clone) -> Self {
        let count = lower.len();
        let buckets = count.clamp(1, MAX_BUCKETS);
        let buckets_per_nm = buckets as f64 / (BAND_NM.1 - BAND_NM.0);
        let mut first = Vec::with_capacity(buckets + 1);
        let mut rest = lower.clone().skip(1).peekable();
        let mut segment = 0_u32;
        for bucket in 0..=buckets {
            // Rounding may put a wavelength into the next bucket. With the margin, the search never
            // starts beyond the segment that contains the wavelength.
            let edge = BAND_NM.0 + bucket as f64 / buckets_per_nm - 1e-9;
            while rest.next_if(|&lower| lower <= edge).is_some() {
                segment += 1;
            }
            first.push(segment);
        }
        if lower.clone().next().is_some_and(|lowest| lowest < BAND_NM.0) {
            // The first bucket also contains the segments below the band.
            first[0] = 0;
        }
        if let Some(last) = first.last_mut() {
            *last = (count.max(1) - 1) as u32;
        }
        Self { buckets_per_nm, first }
    }

    /// Returns the last segment whose lower end, by `lower`, is ≤ `nm` (in the band).
    #[inline]
    pub(crate) fn find(&self, nm: f64, lower: impl Fn(usize) -> f64) -> usize {
        let buckets = self.first.len() - 1;
        let bucket = (((nm - BAND_NM.0) * self.buckets_per_nm) as usize).min(buckets - 1);
        let mut segment = self.first[bucket] as usize;
        // Because of the margin and of rounding, the segment may begin after the stored upper end
        // of this bucket, so the search extends to the end of the next one.
        let mut last = self.first[(bucket + 2).min(buckets)] as usize;
        if last - segment <= MAX_LINEAR_SEARCH {
            while segment < last && lower(segment + 1) <= nm {
                segment += 1;
            }
            return segment;
        }
        while segment < last {
            let middle = segment + (last - segment).div_ceil(2);
            if lower(middle) <= nm { segment = middle } else { last = middle - 1 }
        }
        segment
    }
}
