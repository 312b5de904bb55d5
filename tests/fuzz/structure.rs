//! Systematic changes of the structure of a text: each key, value, line and word in turn is
//! missing, empty, doubled or of another type. Random changes seldom find the one key whose absence
//! matters.

use serde_json::{Value, json};

/// Returns all texts in which one part differs from the valid one.
pub(crate) fn variants(good: &[u8]) -> Vec<Vec<u8>> {
    match (serde_json::from_slice::<Value>(good), std::str::from_utf8(good)) {
        (Ok(value), _) => of_json(&value),
        (Err(_), Ok(text)) => of_text(text),
        (Err(_), Err(_)) => Vec::new(),
    }
}

/// A place in a JSON value: the numbers of the entries on the way to it.
type Place = Vec<usize>;

fn of_json(whole: &Value) -> Vec<Vec<u8>> {
    let mut places = Vec::new();
    collect(whole, &mut Vec::new(), &mut places);
    let others = [json!(null), json!({}), json!([]), json!(""), json!(-1), json!(99), json!(1.5), json!(true)];
    let mut found = Vec::new();
    for place in places {
        for other in &others {
            let mut changed = whole.clone();
            *inside(&mut changed, &place) = other.clone();
            found.push(changed.to_string().into_bytes());
        }
        let Some((last, parents)) = place.split_last() else { continue };
        let mut missing = whole.clone();
        match inside(&mut missing, parents) {
            Value::Object(entries) => {
                let key = entries.keys().nth(*last).cloned().expect("the place exists");
                entries.shift_remove(&key);
            }
            Value::Array(items) => drop(items.remove(*last)),
            Value::Null | Value::Bool(_) | Value::Number(_) | Value::String(_) => {}
        }
        found.push(missing.to_string().into_bytes());
        let mut doubled = whole.clone();
        if let Value::Array(items) = inside(&mut doubled, parents) {
            items.insert(*last, items[*last].clone());
            found.push(doubled.to_string().into_bytes());
        }
    }
    found
}

fn collect(value: &Value, place: &mut Place, places: &mut Vec<Place>) {
    places.push(place.clone());
    let below: Vec<&Value> = match value {
        Value::Object(entries) => entries.values().collect(),
        Value::Array(items) => items.iter().collect(),
        Value::Null | Value::Bool(_) | Value::Number(_) | Value::String(_) => Vec::new(),
    };
    for (number, part) in below.into_iter().enumerate() {
        place.push(number);
        collect(part, place, places);
        place.pop();
    }
}

fn inside<'v>(value: &'v mut Value, place: &[usize]) -> &'v mut Value {
    let Some((first, rest)) = place.split_first() else { return value };
    let part = match value {
        Value::Object(entries) => entries.values_mut().nth(*first),
        Value::Array(items) => items.get_mut(*first),
        Value::Null | Value::Bool(_) | Value::Number(_) | Value::String(_) => None,
    };
    inside(part.expect("the place exists"), rest)
}

fn of_text(text: &str) -> Vec<Vec<u8>> {
    let lines: Vec<&str> = text.split_inclusive('\n').collect();
    let mut found = Vec::new();
    for (number, line) in lines.iter().enumerate() {
        let words: Vec<&str> = line.split_inclusive([' ', '/']).collect();
        let mut others =
            vec![String::new(), format!("{line}{line}"), format!("  {line}"), format!("{} x\n", line.trim())];
        for word in 0..words.len() {
            let with = |new: &str| [&words[..word].concat(), new, &words[word + 1..].concat()].concat();
            let again = words[word].repeat(2);
            others.extend(["", "\n", "x ", "-1 ", "nan ", "1e999 ", "99 ", &again].map(with));
        }
        let around =
            |other: String| [&lines[..number].concat(), other.as_str(), &lines[number + 1..].concat()].concat();
        found.extend(others.into_iter().map(|other| around(other).into_bytes()));
    }
    found
}
