//! Each example scene calls for the effects that scenes/README.md says, and no others.

use abbe::render::Job;
use abbe::scene::resolve;
use std::path::Path;

#[test]
fn the_table_of_example_scenes_is_what_their_plans_say() {
    let folder = Path::new(env!("CARGO_MANIFEST_DIR")).join("scenes");
    let readme = std::fs::read_to_string(folder.join("README.md")).unwrap();
    let mut listed: Vec<&str> = Vec::new();
    for row in readme.lines().filter(|line| line.starts_with("| `")) {
        let cells: Vec<&str> = row.trim_matches('|').split('|').map(str::trim).collect();
        let name = cells[0].trim_matches('`');
        let job = Job::new(resolve::load(&folder.join(format!("{name}.json")), &[]).unwrap()).unwrap();
        let on: Vec<&str> = job.rows.iter().filter(|row| row.state.is_on()).map(|row| row.effect.name).collect();
        assert_eq!(cells[2], on.join(", "), "{name}");
        listed.push(name);
    }
    let files = std::fs::read_dir(&folder).unwrap().map(|entry| entry.unwrap().file_name().into_string().unwrap());
    for file in files.filter(|file| file.ends_with(".json") && !file.ends_with(".schema.json")) {
        assert!(listed.contains(&file.trim_end_matches(".json")), "{file} is not in the table");
    }
}
