//! Sorting by a number. The sort of the standard library is compiled for each type of element, to
//! about 8 kB of machine code; this sort is compiled once.

/// Sorts items by a number, computed once per item, in ascending order. Items with equal numbers
/// keep their order, and NaN is above or below all other numbers, by its sign.
pub fn sort_by_number<T>(items: &mut [T], number: impl Fn(&T) -> f64) {
    let mut order = ascending_order(items.iter().map(number).collect());
    // Follows each cycle of the permutation: item `order[i]` moves to place i.
    for start in 0..items.len() {
        let mut place = start;
        loop {
            let from = std::mem::replace(&mut order[place], place);
            if from == start {
                break;
            }
            items.swap(place, from);
            place = from;
        }
    }
}

#[inline(never)]
fn ascending_order(numbers: Vec<f64>) -> Vec<usize> {
    let mut pairs: Vec<(f64, usize)> = numbers.into_iter().zip(0..).collect();
    pairs.sort_unstable_by(|a, b| a.0.total_cmp(&b.0).then(a.1.cmp(&b.1)));
    pairs.into_iter().map(|(_, index)| index).collect()
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::math::random::{Purpose, Seed, Stream};

    /// Compares with the stable sort of the standard library, for lists with many equal numbers.
    #[test]
    fn items_are_sorted_as_by_a_stable_sort() {
        let mut stream = Stream::new(Seed::new(0), Purpose::Pass, 0, 0);
        for count in 0..200 {
            let mut items: Vec<(f64, usize)> =
                (0..count).map(|index| ((stream.uniform() * 10.0).floor() - 5.0, index)).collect();
            let mut expected = items.clone();
            expected.sort_by(|a, b| a.0.total_cmp(&b.0));
            sort_by_number(&mut items, |item| item.0);
            assert_eq!(items, expected);
        }
    }
}
