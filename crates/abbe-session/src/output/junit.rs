//! JUnit XML: the report format of test results that continuous integration reads.

use std::fmt::Write as _;

#[derive(Debug, Clone, PartialEq, Eq)]
pub struct JunitCase<'a> {
    pub group: &'a str,
    pub name: &'a str,
    /// The reason of the failure, or `None` if the test passed.
    pub failure: Option<&'a str>,
}

/// Returns the XML of a suite with its properties (names and values) and cases.
pub fn junit(suite: &str, properties: &[(&str, &str)], cases: &[JunitCase<'_>]) -> String {
    let failures = cases.iter().filter(|case| case.failure.is_some()).count();
    let (suite, count) = (escaped(suite), cases.len());
    let mut text = format!(
        "<?xml version=\"1.0\" encoding=\"UTF-8\"?>\n<testsuites tests=\"{count}\" failures=\"{failures}\">\n  \
         <testsuite name=\"{suite}\" tests=\"{count}\" failures=\"{failures}\" errors=\"0\" skipped=\"0\">\n"
    );
    if !properties.is_empty() {
        text += "    <properties>\n";
        for (name, value) in properties {
            let _ = writeln!(text, "      <property name=\"{}\" value=\"{}\"/>", escaped(name), escaped(value));
        }
        text += "    </properties>\n";
    }
    for case in cases {
        let _ = write!(text, "    <testcase classname=\"{}\" name=\"{}\"", escaped(case.group), escaped(case.name));
        text += &case.failure.map_or("/>\n".to_string(), |reason| {
            let reason = escaped(reason);
            format!(">\n      <failure message=\"{reason}\">{reason}</failure>\n    </testcase>\n")
        });
    }
    text + "  </testsuite>\n</testsuites>\n"
}

/// Escapes a text for XML, where control characters are not allowed and become spaces.
fn escaped(text: &str) -> String {
    let mut out = String::with_capacity(text.len());
    for c in text.chars() {
        match c {
            '&' => out += "&amp;",
            '<' => out += "&lt;",
            '>' => out += "&gt;",
            '"' => out += "&quot;",
            c if c.is_control() => out.push(' '),
            c => out.push(c),
        }
    }
    out
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn a_report_is_xml_with_its_counts() {
        let case = |name, failure| JunitCase { group: "a<b", name, failure };
        let text =
            junit("\"set\" & 1", &[("cause", "<1")], &[case("good", None), case("bad\u{1}", Some("1 < 2 & \"x\""))]);
        let document = roxmltree::Document::parse(&text).unwrap();
        let find = |tag: &str| document.descendants().find(|node| node.has_tag_name(tag)).unwrap();
        let suite = find("testsuite");
        assert_eq!(suite.attribute("name"), Some("\"set\" & 1"));
        assert_eq!((suite.attribute("tests"), suite.attribute("failures")), (Some("2"), Some("1")));
        assert_eq!(find("failure").text(), Some("1 < 2 & \"x\""));
        let names: Vec<_> = document.descendants().filter_map(|node| node.attribute("classname")).collect();
        assert_eq!(names, ["a<b", "a<b"]);
        assert_eq!(find("property").attribute("value"), Some("<1"));
    }
}
