//! Doc comments begin with their subject, so that each can be read alone.

use std::path::Path;

use pinwheel_tests::repository;

/// Doc comments of the crates that may begin without a subject: the number when the rule was made, which may only fall.
/// All are help texts, which clap takes from comments.
const LIMIT: usize = 4;

/// Lists the doc comments below a folder that begin with a word that stands for something said elsewhere.
fn without_subject(folder: &Path, list: &mut Vec<String>) {
    const WORDS: [&str; 5] = ["The same", "Those", "What", "Whether", "Of"];
    for entry in std::fs::read_dir(folder).expect("a folder") {
        let path = entry.expect("an entry").path();
        if path.is_dir() {
            without_subject(&path, list);
        } else if path.extension().is_some_and(|extension| extension == "rs") {
            let text = std::fs::read_to_string(&path).expect("text");
            let mut inside = false;
            for (number, line) in text.lines().enumerate() {
                let line = line.trim_start();
                let comment = line.strip_prefix("/// ").or(line.strip_prefix("//! "));
                let begins = comment.filter(|_| !inside).is_some_and(|comment| {
                    let rest = WORDS.iter().find_map(|word| comment.strip_prefix(word));
                    rest.is_some_and(|rest| !rest.starts_with(char::is_alphanumeric))
                });
                inside = comment.is_some();
                if begins {
                    list.push(format!("{}:{}: {line}", path.display(), number + 1));
                }
            }
        }
    }
}

#[test]
fn regress_doc_comments_name_their_subject() {
    let mut list = Vec::new();
    for entry in std::fs::read_dir(repository("crates")).expect("crates") {
        let sources = entry.expect("an entry").path().join("src");
        if sources.is_dir() {
            without_subject(&sources, &mut list);
        }
    }
    assert!(list.len() <= LIMIT, "{}", list.join("\n"));
}
