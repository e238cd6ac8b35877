//! Recognises names of ceilings in several languages.

/// Words for a ceiling, in lower case. `HEADS` may also end a compound, such as "Zimmerdecke" or "controsoffitto".
/// `WORDS` count only as whole words, because unrelated words end in them: an "arquiteto" is an architect. Japanese
/// puts no spaces between words, so `PARTS` may stand anywhere within a word.
const HEADS: [&str; 10] =
    ["ceiling", "ceilings", "decke", "decken", "plafond", "plafonds", "soffitto", "soffitti", "потолок", "потолки"];
const WORDS: [&str; 4] = ["techo", "techos", "teto", "tetos"];
const PARTS: [&str; 1] = ["天井"];

/// Beginnings of German words that end in "decke" or "decken" and mean no ceiling. `BLANKETS`: blankets, table cloths,
/// and layers of snow and clouds. `CORNERS`: compounds of "Ecke" (corner), such as "Wandecke".
const BLANKETS: [&str; 19] = [
    "bett", "tisch", "tages", "woll", "stepp", "daunen", "kuschel", "picknick", "heiz", "strick", "fell", "pferde",
    "krabbel", "baby", "sofa", "plüsch", "über", "schnee", "wolken",
];
const CORNERS: [&str; 3] = ["wan", "ran", "bil"];

/// Whether a name contains a word for a ceiling.
pub fn is_ceiling(name: &str) -> bool {
    // `letters` joins the words of the name up to the current word, because a compound may be split into words:
    // "Bett_Decke" becomes "bettdecke", which is a blanket.
    let mut letters = String::new();
    words(name).split_whitespace().any(|word| {
        letters.push_str(word);
        let is_head = |head: &&str| word.ends_with(*head) && !is_other_compound(&letters, head);
        HEADS.iter().any(is_head) || WORDS.contains(&word) || PARTS.iter().any(|part| word.contains(part))
    })
}

/// Returns the words of a name in lower case, with spaces between them. A word ends at a character that is no letter,
/// and where a capital letter follows a small one.
fn words(name: &str) -> String {
    let mut words = String::new();
    let mut is_small = false;
    for letter in name.chars() {
        if !letter.is_alphabetic() || (is_small && letter.is_uppercase()) {
            words.push(' ');
        }
        if letter.is_alphabetic() {
            words.extend(letter.to_lowercase());
        }
        is_small = letter.is_lowercase();
    }
    words
}

/// Whether `letters` end in a German compound that means no ceiling: a beginning from [`BLANKETS`] or [`CORNERS`], then
/// `head`. False unless `head` is "decke" or "decken".
fn is_other_compound(letters: &str, head: &str) -> bool {
    let Some(first) = letters.strip_suffix(head).filter(|_| head.starts_with("decke")) else { return false };
    BLANKETS.iter().chain(&CORNERS).any(|other| first.ends_with(other))
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn ceilings_are_recognised_in_all_languages() {
        for name in [
            "Ceiling",
            "RoomCeiling.001",
            "ceiling_main",
            "suspendedceiling",
            "Decke",
            "Zimmerdecke",
            "Geschossdecken",
            "DECKE_EG",
            "Plafond",
            "faux-plafond",
            "systeemplafond",
            "Soffitto",
            "controsoffitto",
            "el techo",
            "Teto_01",
            "木製天井01",
            "Потолок",
        ] {
            assert!(is_ceiling(name), "{name}");
        }
    }

    #[test]
    fn words_that_only_contain_a_ceiling_are_none() {
        for name in [
            "Bettdecke",
            "Bett_Decke",
            "BettDecke.002",
            "Tagesdecken",
            "Tischdecke",
            "Überdecke",
            "Wandecke",
            "Deckenlampe",
            "Entdecker",
            "Arquiteto",
            "Plafonnier",
            "Tetons",
            "",
            "...",
        ] {
            assert!(!is_ceiling(name), "{name}");
        }
        // A bed elsewhere in the name does not turn a ceiling into a blanket.
        assert!(is_ceiling("Schlafzimmerdecke") && is_ceiling("Decke über Bett"));
    }
}
