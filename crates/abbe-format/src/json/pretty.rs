//! Writes JSON for people: short values on one line, and lists of numbers in full lines.

use serde_json::Value;

/// The longest line in characters, unless a single value is longer.
const LINE_WIDTH: usize = 100;

/// Writes JSON on one line, with blanks after commas and colons.
pub fn one_line(value: &Value) -> String {
    match value {
        Value::Object(entries) => {
            let entries = entries.iter().map(|(key, value)| format!("{}: {}", quoted(key), one_line(value)));
            format!("{{{}}}", entries.collect::<Vec<_>>().join(", "))
        }
        Value::Array(elements) => format!("[{}]", elements.iter().map(one_line).collect::<Vec<_>>().join(", ")),
        Value::Null | Value::Bool(_) | Value::Number(_) | Value::String(_) => value.to_string(),
    }
}

/// Writes JSON on several lines, which end with a newline. A value that fits is not broken.
pub fn pretty(value: &Value) -> String {
    let mut text = String::new();
    write(value, 0, 0, &mut text);
    text + "\n"
}

fn quoted(key: &str) -> String {
    Value::from(key).to_string()
}

fn is_numeric(value: &Value) -> bool {
    match value {
        Value::Number(_) => true,
        Value::Array(elements) => elements.iter().all(Value::is_number),
        Value::Null | Value::Bool(_) | Value::String(_) | Value::Object(_) => false,
    }
}

/// Appends a value. The current line has `column` characters and the indentation `indent`.
fn write(value: &Value, indent: usize, column: usize, text: &mut String) {
    let line = one_line(value);
    let inner = " ".repeat(indent + 2);
    match value {
        _ if column + line.chars().count() < LINE_WIDTH => text.push_str(&line),
        Value::Object(entries) => {
            text.push_str("{\n");
            for (i, (key, value)) in entries.iter().enumerate() {
                let key = format!("{inner}{}: ", quoted(key));
                text.push_str(&key);
                write(value, indent + 2, key.chars().count(), text);
                text.push_str(if i + 1 < entries.len() { ",\n" } else { "\n" });
            }
            text.push_str(&" ".repeat(indent));
            text.push('}');
        }
        Value::Array(elements) if elements.iter().all(is_numeric) => {
            text.push('[');
            let mut column = LINE_WIDTH;
            for (i, element) in elements.iter().enumerate() {
                let element = one_line(element);
                let start = if column + element.len() + 2 > LINE_WIDTH { format!("\n{inner}") } else { " ".into() };
                column = if start == " " { column + 1 } else { indent + 2 };
                text.push_str(&start);
                text.push_str(&element);
                text.push_str(if i + 1 < elements.len() { "," } else { "" });
                column += element.len() + 1;
            }
            text.push('\n');
            text.push_str(&" ".repeat(indent));
            text.push(']');
        }
        Value::Array(elements) => {
            text.push_str("[\n");
            for (i, element) in elements.iter().enumerate() {
                text.push_str(&inner);
                write(element, indent + 2, indent + 2, text);
                text.push_str(if i + 1 < elements.len() { ",\n" } else { "\n" });
            }
            text.push_str(&" ".repeat(indent));
            text.push(']');
        }
        Value::Null | Value::Bool(_) | Value::Number(_) | Value::String(_) => text.push_str(&line),
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use serde_json::json;

    #[test]
    fn a_written_value_has_short_lines_and_is_read_back() {
        let points: Vec<[f64; 3]> = (0..40).map(|i| [f64::from(i), 0.5, -1e-9]).collect();
        let value =
            json!({"a \"b\"": {"positions": points, "name": "x"}, "list": [{"one": 1}, {"two": "2".repeat(80)}]});
        let text = pretty(&value);
        assert_eq!(serde_json::from_str::<Value>(&text).expect("the text is JSON"), value);
        assert!(text.lines().all(|line| line.chars().count() <= LINE_WIDTH + 2), "{text}");
        assert!(text.lines().count() < 25 && text.contains("{\"one\": 1},\n"), "{text}");
    }
}
