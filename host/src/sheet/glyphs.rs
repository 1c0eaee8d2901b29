//! Letters made of lines, for pictures: a grid of 5 columns, capitals 6 high, small letters 4, descenders 2 below the base line.
//!
//! Each letter is a list of polylines parted by spaces. A point is a column and a row; rows below the base line are `a` (-1) and `b` (-2).
//! A polyline of one place twice is a dot.

/// Columns from one letter to the next.
pub(super) const ADVANCE: f64 = 6.0;
/// Rows of a capital.
pub(super) const CAPITAL: f64 = 6.0;

/// From space to tilde.
const LETTERS: [&str; 95] = [
    "",
    "2622 2020",
    "1614 3634",
    "1016 3036 0242 0444",
    "453616050413334241301001 2620",
    "0046 0506161505 3031414030",
    "4014152635340201102042",
    "2624",
    "36252130",
    "16252110",
    "2521 0442 0244",
    "2521 0343",
    "201a",
    "0343",
    "2020",
    "0046",
    "103041453616050110",
    "152620 1030",
    "05163645440040",
    "0516364544334241301001 2333",
    "30360242",
    "460604344341301001",
    "3616050110304142331302",
    "064610",
    "13040516364544331302011030414233",
    "1030414536160504133344",
    "2323 2020",
    "2323 201a",
    "350331",
    "0444 0242",
    "154311",
    "05163645442322 2020",
    "3414123234 324245361605011040",
    "002640 1232",
    "00063645443303 3342413000",
    "4536160501103041",
    "00063645413000",
    "46060040 0333",
    "460600 0333",
    "45361605011030414323",
    "0006 4046 0343",
    "1030 1636 2026",
    "4641301001",
    "0006 460340",
    "060040",
    "0006234640",
    "00064046",
    "103041453616050110",
    "00063645443303",
    "103041453616050110 2240",
    "00063645443303 2340",
    "453616050413334241301001",
    "0646 2620",
    "060110304146",
    "062046",
    "0610233046",
    "0046 0640",
    "062346 2320",
    "06460040",
    "36161030",
    "0640",
    "16363010",
    "042644",
    "0a4a",
    "1625",
    "4440 4334140301103041",
    "0600 0314344341301001",
    "4334140301103041",
    "4640 4334140301103041",
    "02424334140301103041",
    "36261510 0434",
    "444a3b1b0a 4334140301103041",
    "0600 0314344340",
    "2420 2626",
    "343a2b1b 3636",
    "0600 340240",
    "262130",
    "0400 03142320 23344340",
    "0400 0314344340",
    "103041433414030110",
    "040b 0314344341301001",
    "444b 4334140301103041",
    "0400 03143443",
    "43341403123241301001",
    "16112030 0434",
    "0401103041 4440",
    "042044",
    "0410233044",
    "0044 0440",
    "0420 441b",
    "04440040",
    "36252413222130",
    "262a",
    "16252433222110",
    "03143243",
];

/// Stands for every other letter: a box.
const OTHER: &str = "0006464000";

/// Lines of a letter: ends in columns to the right and rows up.
pub(super) fn lines(letter: char) -> Vec<[[f64; 2]; 2]> {
    let at = (letter as usize).checked_sub(0x20);
    let text = at.and_then(|at| LETTERS.get(at)).copied().unwrap_or(OTHER);
    let point = |pair: &[u8; 2]| {
        let row = match pair[1] {
            below @ b'a'..=b'b' => f64::from(b'a') - f64::from(below) - 1.0,
            row => f64::from(row) - f64::from(b'0'),
        };
        [f64::from(pair[0]) - f64::from(b'0'), row]
    };
    let polyline = |text: &str| text.as_bytes().as_chunks::<2>().0.iter().map(point).collect::<Vec<_>>();
    let ends = |points: Vec<[f64; 2]>| points.windows(2).map(|pair| [pair[0], pair[1]]).collect::<Vec<_>>();
    text.split(' ').map(polyline).flat_map(ends).collect()
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn every_letter_is_on_its_grid() {
        for (index, text) in LETTERS.iter().enumerate() {
            let letter = char::from(b' ' + index as u8);
            assert!(text.split(' ').all(|line| line.len() % 2 == 0), "{letter}: {text}");
            let lines = lines(letter);
            assert_eq!(lines.is_empty(), letter == ' ', "{letter}");
            for [x, y] in lines.as_flattened() {
                assert!((0.0..=4.0).contains(x) && (-2.0..=6.0).contains(y), "{letter}: {x} {y}");
            }
        }
        assert_eq!(lines('ö'), lines('字'));
    }
}
