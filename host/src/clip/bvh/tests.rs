//! The two readers, block by block and of the whole text, give the same bits.

use super::*;
use crate::clip::WriteOptions;
use crate::gait::{Manner, walk};

/// Reads block by block and whole; nothing where the text is not plain.
fn both(bytes: &[u8], options: &ReadOptions) -> Option<[Result<Clip, ParseError>; 2]> {
    Some([read(&mut &*bytes, bytes.len(), options)?, parse_any(bytes, options)])
}

fn bits(clip: &Clip) -> Vec<u64> {
    let root = clip.root.iter().flat_map(|p| p.iter());
    let turns = clip.rotations.iter().flat_map(|r| r.coords.iter());
    root.chain(turns).chain([&clip.frame_time]).map(|x| x.to_bits()).collect()
}

fn same(bytes: &[u8], name: &str) {
    let [plain, any] = both(bytes, &ReadOptions::default()).unwrap_or_else(|| panic!("{name} is not plain"));
    match (plain, any) {
        (Ok(plain), Ok(any)) => {
            assert_eq!((&plain.skeleton, &plain.notes), (&any.skeleton, &any.notes), "{name}");
            assert!(bits(&plain) == bits(&any), "{name}: other bits");
        }
        (plain, any) => assert_eq!(plain.err(), any.err(), "{name}"),
    }
}

fn made() -> String {
    walk(&Manner::WEARY, 3.0, 60.0, 0.0, 1).to_bvh(&WriteOptions::default()).unwrap()
}

/// The text with its frames so many times.
fn longer(text: &str, times: usize) -> String {
    let (head, frames) = text.split_once("Frames:").unwrap();
    let (time, frames) = frames.split_once("Frame Time:").unwrap();
    let (rate, frames) = frames.split_once('\n').unwrap();
    let count = times * time.trim().parse::<usize>().unwrap();
    format!("{head}Frames: {count}\nFrame Time:{rate}\n{}", frames.repeat(times))
}

#[test]
fn plain_text_gives_the_same_bits_by_both() {
    let text = made();
    same(text.as_bytes(), "as we write it");
    same(text.replace('\n', "\r\n").as_bytes(), "CRLF");
    same(text.replace(' ', " \t ").replace('\n', "\n\n \n").as_bytes(), "white space");
}

#[test]
fn many_blocks_give_the_same_bits() {
    let long = longer(&made(), 60);
    assert!(long.len() > 5 << 20, "{} bytes are not many blocks", long.len());
    same(long.as_bytes(), "many blocks");
    // A word of another kind behind the first blocks, and a frame that is cut off.
    for broken in [format!("{long}1 2 nan\n"), long.trim_end().rsplit_once(' ').unwrap().0.to_owned()] {
        assert!(both(broken.as_bytes(), &ReadOptions::default()).is_none());
        assert!(parse(broken.as_bytes(), &ReadOptions::default()).is_err());
    }
}

#[test]
fn dialects_and_faults_are_left_to_the_reader_of_the_whole_text() {
    let text = made();
    let (head, frames) = text.split_once("Frame Time:").unwrap();
    for other in [
        text.replace('\n', "\r"),
        format!("{head}Frame Time:{}", frames.replacen(' ', "\n", 3)),
        format!("{head}Frame Time:{}", frames.replace('.', ",")),
        text.replace("MOTION", "Motion Sickness"),
        text.replace("Frames: ", "Frames: 9"),
        String::new(),
    ] {
        assert!(both(other.as_bytes(), &ReadOptions::default()).is_none());
    }
}

#[test]
fn real_clips_give_the_same_bits_by_both() {
    let Some(data) = kinesic_tests::data("real_clips_give_the_same_bits_by_both") else { return };
    let (mut plain, mut folders) = (0, vec![data]);
    while let Some(folder) = folders.pop() {
        for entry in std::fs::read_dir(folder).unwrap() {
            let path = entry.unwrap().path();
            if path.is_dir() {
                folders.push(path);
            } else if path.extension().is_some_and(|e| e == "bvh") {
                let bytes = std::fs::read(&path).unwrap();
                same(&bytes, &path.display().to_string());
                plain += 1;
            }
        }
    }
    println!("{plain} clips");
    assert!(plain > 500, "{plain} clips");
}
