//! What can be wrong with a BVH file, by line.

/// What is wrong with a BVH file, and where. Lines count from 1.
#[derive(Clone, Debug, PartialEq, thiserror::Error)]
#[non_exhaustive]
#[allow(missing_docs)] // The messages say what the fields are.
pub enum BvhFault {
    #[error("the file is empty, expected BVH text. Export the clip again")]
    Empty,
    #[error(
        "line {line}: byte {byte:#04x} is not UTF-8 text; this looks like a binary file or another encoding. \
             Export the clip as BVH text, or save the file as UTF-8"
    )]
    NotText { line: usize, byte: u8 },
    #[error("line {line}: expected HIERARCHY, found '{found}'; this is not a BVH file. Export the clip as BVH")]
    NotBvh { line: usize, found: String },
    #[error("line {line}: the keyword HIERARCHY is missing, found '{found}'. Put a line HIERARCHY before the ROOT")]
    MissingHierarchy { line: usize, found: String },
    #[error("line {line}: expected ROOT and a name after HIERARCHY, found '{found}'. Name the first joint with ROOT")]
    MissingRoot { line: usize, found: String },
    #[error("there is no ROOT '{name}'; the file has: {roots}. Name one of them with --root")]
    NoSuchRoot { name: String, roots: String },
    #[error("line {line}: {keyword} without a name. Write the joint's name after the keyword")]
    NoName { line: usize, keyword: &'static str },
    #[error("line {line}: expected '{{' after joint '{joint}', found '{found}'. Check the braces")]
    MissingBrace { line: usize, joint: String, found: String },
    #[error(
        "line {line}: the braces are not balanced: '{found}' while joint '{joint}' (line {opened}) is still open. \
             Add the missing '}}'"
    )]
    UnclosedJoint { line: usize, joint: String, opened: usize, found: String },
    #[error(
        "line {line}: the braces are not balanced: a '}}' too many. Remove it, or put MOTION after the root's '}}'"
    )]
    ExtraBrace { line: usize },
    #[error(
        "line {line}: the file ends inside the hierarchy, joint '{joint}' (line {opened}) is still open. \
             The file is cut off; export or download it again"
    )]
    TruncatedHierarchy { line: usize, joint: String, opened: usize },
    #[error("line {line}: joint '{joint}' has no OFFSET. Add 'OFFSET x y z' to it")]
    MissingOffset { line: usize, joint: String },
    #[error("line {line}: joint '{joint}' has a second OFFSET. Remove one")]
    SecondOffset { line: usize, joint: String },
    #[error("line {line}: OFFSET of joint '{joint}' has {found} numbers, expected 3 (x y z)")]
    OffsetCount { line: usize, joint: String, found: usize },
    #[error("line {line}: OFFSET of joint '{joint}': '{found}' is not a finite number. Write it like 12.5 or 1.25e1")]
    OffsetNumber { line: usize, joint: String, found: String },
    #[error("line {line}: joint '{joint}' has CHANNELS twice. Remove one")]
    SecondChannels { line: usize, joint: String },
    #[error("line {line}: CHANNELS of joint '{joint}': '{found}' is not a count from 0 to 9")]
    ChannelCount { line: usize, joint: String, found: String },
    #[error("line {line}: CHANNELS of joint '{joint}' announces {announced} channels, found {found}. Make both agree")]
    ChannelMismatch { line: usize, joint: String, announced: usize, found: usize },
    #[error(
        "line {line}: joint '{joint}' has an unknown channel '{found}'. Known: Xposition Yposition Zposition Xrotation \
             Yrotation Zrotation, and Xscale Yscale Zscale, which are left out"
    )]
    UnknownChannel { line: usize, joint: String, found: String },
    #[error("line {line}: joint '{joint}' lists channel '{found}' twice. Remove one")]
    DuplicateChannel { line: usize, joint: String, found: String },
    #[error("line {line}: found '{found}' in joint '{joint}', expected OFFSET, CHANNELS, JOINT, End Site or '}}'")]
    Unexpected { line: usize, joint: String, found: String },
    #[error("line {line}: the End Site of joint '{joint}' is broken at '{found}', expected '{{ OFFSET x y z }}'")]
    BrokenEndSite { line: usize, joint: String, found: String },
    #[error(
        "line {line}: joint '{joint}' is number {limit} and one too many; at most {limit} joints are read. \
             Remove helper joints on export"
    )]
    TooManyJoints { line: usize, joint: String, limit: usize },
    #[error("line {line}: joint '{joint}' is nested deeper than {limit} joints. Check the braces")]
    TooDeep { line: usize, joint: String, limit: usize },
    #[error(
        "line {line}: expected MOTION after the hierarchy, found {found}. The file is cut off or the keyword is missing"
    )]
    MissingMotion { line: usize, found: String },
    #[error("no joint has a channel, so the motion is empty. Export the clip with its animation")]
    NoChannels,
    #[error("line {line}: expected 'Frames: N' after MOTION, found '{found}'")]
    MissingFrames { line: usize, found: String },
    #[error("line {line}: 'Frames: {found}': expected a whole number, the count of frames")]
    FrameCount { line: usize, found: String },
    #[error("line {line}: expected 'Frame Time: seconds', found '{found}'")]
    MissingFrameTime { line: usize, found: String },
    #[error(
        "line {line}: 'Frame Time: {found}': expected seconds between frames, a number from 0.00001 to 10 (like 0.008333)"
    )]
    FrameTime { line: usize, found: String },
    #[error("line {line}: frame {frame} has {found} values, expected {expected} (one per channel). {}",
            if *last { "It is the last line: the file may be cut off; export or download it again" }
            else { "Correct the line, or the CHANNELS" })]
    ValueCount { line: usize, frame: usize, found: usize, expected: usize, last: bool },
    #[error("line {line}: frame {frame}, value {value} (joint '{joint}', {channel}): '{found}' is not a number")]
    Value { line: usize, frame: usize, value: usize, joint: String, channel: &'static str, found: String },
    #[error(
        "line {line}: frame {frame}, value {value} (joint '{joint}', {channel}): '{found}' is not finite. \
             Repair or cut the frame; a clip must hold finite numbers only"
    )]
    NotFinite { line: usize, frame: usize, value: usize, joint: String, channel: &'static str, found: String },
    #[error(
        "line {line}: the file ends after {found} frames, but line {declared_line} declares {declared}. \
             The file is cut off, or the count is wrong"
    )]
    FewerFrames { line: usize, declared: usize, declared_line: usize, found: usize },
}
