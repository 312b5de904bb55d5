//! Repairs of a text with several faults, so that one run reads and checks the rest of it as well.

use super::deserialize_error::{DeserializeError, DeserializeErrorKind};
use super::positions::{SpannedValue, ValueKind};
use abbe_spectra::error::nearest_name;
use std::collections::BTreeSet;

/// The repairs of a text. Nodes are given by their numbers.
#[derive(Debug, Clone, Default, PartialEq, Eq)]
pub(super) struct Repairs {
    /// Values that are replaced by a stand-in.
    replaced: BTreeSet<u32>,
    /// Keys that are ignored together with their values.
    dropped: BTreeSet<u32>,
    /// Keys that are added to objects, with a stand-in as their value.
    added: BTreeSet<(u32, &'static str)>,
}

#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub(super) struct RepairOutcome {
    /// True if the error is a fault of the text. Otherwise the error only follows from a repair.
    pub(super) is_fault: bool,
    /// True if the text can be read again with the new repair.
    pub(super) can_continue: bool,
}

impl Repairs {
    pub(super) fn replaces(&self, value: SpannedValue) -> bool {
        self.replaced.contains(&value.id())
    }

    pub(super) fn drops(&self, key: SpannedValue) -> bool {
        self.dropped.contains(&key.id())
    }

    pub(super) fn added_to(&self, object: SpannedValue) -> impl Iterator<Item = &'static str> {
        let id = object.id();
        self.added.range((id, "")..(id + 1, "")).map(|(_, key)| *key)
    }

    /// Adds the repair of an error. `root` is the outermost value of the text.
    pub(super) fn repair(&mut self, error: &DeserializeError, root: SpannedValue) -> RepairOutcome {
        let place = error.place(root);
        let id = place.id();
        let is_key = root.is_key(id);
        let is_object = !is_key && place.kind() == ValueKind::Object;
        let dropped = || place.entries().map(|(key, _)| key).filter(|key| is_object && self.drops(*key));
        let (is_fault, is_new) = if let (DeserializeErrorKind::Missing(key), true) = (error.kind(), is_object) {
            // A misspelt key and the missing key are one fault.
            let is_misspelt = dropped().any(|other| nearest_name(&other.content(), [*key]).is_some());
            (!is_misspelt, self.added.insert((id, key)))
        } else if matches!(error.kind(), DeserializeErrorKind::NoStandIn) {
            (false, self.replaced.insert(id))
        } else if is_key {
            (true, self.dropped.insert(id))
        } else {
            let follows = dropped().next().is_some();
            (!follows, self.replaced.insert(id))
        };
        RepairOutcome { is_fault: is_fault && is_new, can_continue: is_new && !self.replaces(root) }
    }

    /// Returns whether a repair concerns this value, a part of it, or a value that contains it.
    pub(super) fn concern(&self, value: SpannedValue) -> bool {
        let touches = |id: u32| value.contains(id) || value.with_id(id).contains(value.id());
        let mut owners = self.added.iter().map(|(object, _)| *object);
        self.replaced.iter().any(|&id| touches(id))
            || self.dropped.iter().any(|&id| value.contains(id))
            || owners.any(|object| value.id() == object)
    }
}
