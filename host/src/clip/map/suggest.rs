//! "Did you mean": the nearest spelling.

/// The candidate with the fewest edits (case does not count), if few enough to be a slip.
pub fn nearest<'a>(word: &str, candidates: impl IntoIterator<Item = &'a str>) -> Option<String> {
    let lower = word.to_lowercase();
    let all = candidates.into_iter().map(|c| (edits(&lower, &c.to_lowercase()), c));
    let (edits, best) = all.min_by_key(|&(e, _)| e)?;
    (edits <= 2.max(word.chars().count() / 3)).then(|| best.to_owned())
}

/// Levenshtein distance.
fn edits(a: &str, b: &str) -> usize {
    let b: Vec<char> = b.chars().collect();
    let mut row: Vec<usize> = (0..=b.len()).collect();
    for (i, ca) in a.chars().enumerate() {
        let mut diagonal = i;
        row[0] = i + 1;
        for (j, cb) in b.iter().enumerate() {
            let substituted = diagonal + usize::from(ca != *cb);
            diagonal = row[j + 1];
            row[j + 1] = substituted.min(row[j] + 1).min(diagonal + 1);
        }
    }
    row.last().copied().unwrap_or(0)
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn slips_are_found_and_nonsense_is_not() {
        assert_eq!(nearest("left_knee", ["l_knee", "r_knee"]).as_deref(), Some("l_knee"));
        assert_eq!(nearest("Pelvs", ["pelvis", "spine"]).as_deref(), Some("pelvis"));
        assert_eq!(nearest("tail", ["pelvis", "l_shoulder"]), None);
        assert_eq!(edits("kitten", "sitting"), 3);
    }
}
