//! Tasks on the thread pool.
//!
//! The adapters of rayon are compiled for each place of use, with about 5 kB of machine code. The
//! loop over these tasks is compiled once.

use rayon::prelude::*;
use std::ops::Range;
use std::sync::{Mutex, PoisonError};

/// Converts each item in a task of its own, on the current thread pool. The results have the order
/// of the items. The items should take much longer than a lock.
pub fn map<I: Send, T: Send>(items: Vec<I>, convert: impl Fn(I) -> T + Sync) -> Vec<T> {
    let slots: Vec<Mutex<(Option<I>, Option<T>)>> =
        items.into_iter().map(|item| Mutex::new((Some(item), None))).collect();
    run(slots.len(), &|number| {
        let slot = || slots[number].lock().unwrap_or_else(PoisonError::into_inner);
        let item = slot().0.take();
        let result = item.map(&convert);
        slot().1 = result;
    });
    slots.into_iter().filter_map(|slot| slot.into_inner().unwrap_or_else(PoisonError::into_inner).1).collect()
}

/// Returns the results of a function for each number of a range. Each task computes `share`
/// results.
pub fn map_range<T: Send>(range: Range<usize>, share: usize, result: impl Fn(usize) -> T + Sync) -> Vec<T> {
    let tasks = range.clone().step_by(share).collect();
    let of_task = |first: usize| (first..(first + share).min(range.end)).map(&result).collect::<Vec<T>>();
    map(tasks, of_task).into_iter().flatten().collect()
}

/// Runs all tasks.
#[inline(never)]
fn run(count: usize, task: &(dyn Fn(usize) + Sync)) {
    (0..count).into_par_iter().for_each(task);
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn results_have_the_order_of_the_items() {
        let items: Vec<String> = (0..1000).map(|i| i.to_string()).collect();
        assert_eq!(map(items, |text| text.parse::<usize>().unwrap()), (0..1000).collect::<Vec<_>>());
        for range in [0..0, 3..4, 5..1000] {
            assert_eq!(map_range(range.clone(), 64, |i| i), range.collect::<Vec<_>>());
        }
    }
}
