//! "Did you mean".

/// The closest of the candidates, if one is close.
pub(crate) fn closest<'a>(
    name: &str,
    candidates: impl Iterator<Item = &'a str>,
) -> Option<&'a str> {
    if name.len() > 64 {
        return None;
    }
    // One letter is close to every other letter.
    let allowed = if name.chars().count() < 2 { 0 } else { 1 + name.chars().count() / 4 };
    candidates
        .filter(|c| *c != name)
        .map(|c| (strsim::damerau_levenshtein(&c.to_lowercase(), &name.to_lowercase()), c))
        .filter(|(distance, c)| *distance <= allowed && *distance < c.chars().count().max(2))
        .min_by(|a, b| a.0.cmp(&b.0).then(a.1.cmp(b.1)))
        .map(|(_, c)| c)
}
