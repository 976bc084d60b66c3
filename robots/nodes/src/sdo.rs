//! The SDO server: expedited and segmented transfers of CiA 301, one at a time.

use shapebot_drive::{Frame, Object};

use crate::Abort;

/// Longest segmented download: no object is longer.
const LONGEST: usize = 64;

/// What a server does with the objects.
pub(crate) trait Objects {
    fn read(&self, object: Object) -> Result<Vec<u8>, Abort>;
    fn write(&mut self, object: Object, bytes: &[u8]) -> Result<(), Abort>;
}

/// A transfer that is under way.
#[derive(Clone, Debug, Default, PartialEq, Eq)]
enum Transfer {
    #[default]
    None,
    Upload {
        object: Object,
        rest: Vec<u8>,
        toggle: bool,
    },
    Download {
        object: Object,
        data: Vec<u8>,
        size: Option<usize>,
        toggle: bool,
    },
}

/// State of the server of one node.
#[derive(Clone, Debug, Default)]
pub(crate) struct Server {
    transfer: Transfer,
}

const TOGGLE: u8 = 1 << 4;

impl Server {
    /// Answers a request; requests that are not eight bytes long get no answer.
    pub(crate) fn answer(&mut self, frame: &Frame, objects: &mut impl Objects) -> Option<[u8; 8]> {
        let request = frame.exactly::<8>()?;
        let [command, low, high, sub, ..] = request;
        let object = Object { index: u16::from_le_bytes([low, high]), sub };
        let answer = match command >> 5 {
            0 => self.download_segment(request, objects),
            1 => self.download(object, request, objects),
            2 => self.upload(object, objects),
            3 => self.upload_segment(command),
            4 => {
                self.transfer = Transfer::None;
                return None;
            }
            _ => Err((object, Abort::Command)),
        };
        Some(answer.unwrap_or_else(|(object, abort)| {
            self.transfer = Transfer::None;
            let [low, high] = object.index.to_le_bytes();
            let [a, b, c, d] = abort.code().to_le_bytes();
            [0x80, low, high, object.sub, a, b, c, d]
        }))
    }

    /// Forgets a transfer that is under way.
    pub(crate) fn reset(&mut self) {
        self.transfer = Transfer::None;
    }

    /// Object of the transfer under way, for an abort.
    fn current(&self) -> Object {
        match &self.transfer {
            Transfer::None => Object { index: 0, sub: 0 },
            Transfer::Upload { object, .. } | Transfer::Download { object, .. } => *object,
        }
    }

    fn upload(&mut self, object: Object, objects: &impl Objects) -> Answer {
        self.transfer = Transfer::None;
        let data = objects.read(object).map_err(|abort| (object, abort))?;
        let [low, high] = object.index.to_le_bytes();
        let mut answer = [0x41, low, high, object.sub, 0, 0, 0, 0];
        let (_, payload) = answer.split_at_mut(4);
        if (1..=4).contains(&data.len()) {
            payload.iter_mut().zip(&data).for_each(|(to, from)| *to = *from);
            let unused = u8::try_from(4 - data.len()).unwrap_or(0);
            answer[0] = 0x43 | (unused << 2);
        } else {
            let size = u32::try_from(data.len()).unwrap_or(u32::MAX);
            payload.copy_from_slice(&size.to_le_bytes());
            self.transfer = Transfer::Upload { object, rest: data, toggle: false };
        }
        Ok(answer)
    }

    fn upload_segment(&mut self, command: u8) -> Answer {
        let object = self.current();
        let Transfer::Upload { rest, toggle, .. } = &mut self.transfer else {
            return Err((object, Abort::Command));
        };
        if (command & TOGGLE != 0) != *toggle {
            return Err((object, Abort::Toggle));
        }
        let count = rest.len().min(7);
        let mut answer = [0; 8];
        answer.iter_mut().skip(1).zip(rest.drain(..count)).for_each(|(to, from)| *to = from);
        let unused = u8::try_from(7 - count).unwrap_or(0);
        answer[0] = (command & TOGGLE) | (unused << 1) | u8::from(rest.is_empty());
        *toggle = !*toggle;
        if rest.is_empty() {
            self.transfer = Transfer::None;
        }
        Ok(answer)
    }

    fn download(&mut self, object: Object, request: [u8; 8], objects: &mut impl Objects) -> Answer {
        self.transfer = Transfer::None;
        let [command, low, high, sub, data @ ..] = request;
        let (expedited, sized) = (command & 0b10 != 0, command & 0b01 != 0);
        if expedited {
            let count = if sized { 4 - usize::from((command >> 2) & 0b11) } else { 4 };
            let bytes = data.get(..count).unwrap_or(&data);
            objects.write(object, bytes).map_err(|abort| (object, abort))?;
        } else {
            let size = sized.then(|| u32::from_le_bytes(data));
            let size = size.map(|size| usize::try_from(size).unwrap_or(usize::MAX));
            if size.is_some_and(|size| size > LONGEST) {
                return Err((object, Abort::Memory));
            }
            let data = Vec::new();
            self.transfer = Transfer::Download { object, data, size, toggle: false };
        }
        Ok([0x60, low, high, sub, 0, 0, 0, 0])
    }

    fn download_segment(&mut self, request: [u8; 8], objects: &mut impl Objects) -> Answer {
        let object = self.current();
        let Transfer::Download { data, size, toggle, .. } = &mut self.transfer else {
            return Err((object, Abort::Command));
        };
        let [command, payload @ ..] = request;
        if (command & TOGGLE != 0) != *toggle {
            return Err((object, Abort::Toggle));
        }
        let count = 7 - usize::from((command >> 1) & 0b111);
        data.extend(payload.iter().take(count));
        if data.len() > size.unwrap_or(LONGEST).min(LONGEST) {
            return Err((object, Abort::TooLong));
        }
        *toggle = !*toggle;
        if command & 1 != 0 {
            if size.is_some_and(|size| size != data.len()) {
                return Err((object, Abort::TooShort));
            }
            let data = std::mem::take(data);
            self.transfer = Transfer::None;
            objects.write(object, &data).map_err(|abort| (object, abort))?;
        }
        Ok([0x20 | (command & TOGGLE), 0, 0, 0, 0, 0, 0, 0])
    }
}

type Answer = Result<[u8; 8], (Object, Abort)>;

#[cfg(test)]
mod tests {
    use super::*;
    use crate::{Access, Dictionary, Mappable};
    use shapebot_drive::DataType;

    impl Objects for Dictionary {
        fn read(&self, object: Object) -> Result<Vec<u8>, Abort> {
            Self::read(self, object)
        }

        fn write(&mut self, object: Object, bytes: &[u8]) -> Result<(), Abort> {
            let number = self.check_write(object, bytes)?;
            self.set(object, number);
            Ok(())
        }
    }

    fn dictionary() -> Dictionary {
        let mut dictionary = Dictionary::default();
        dictionary.text(Object { index: 0x1008, sub: 0 }, "simulated drive");
        let (rw, no) = (Access::ReadWrite, Mappable::No);
        dictionary.number(Object { index: 0x1017, sub: 0 }, DataType::U16, 0, rw, no);
        dictionary.number(
            Object { index: 0x1000, sub: 0 },
            DataType::U32,
            402,
            Access::Constant,
            no,
        );
        dictionary
    }

    fn ask(server: &mut Server, dictionary: &mut Dictionary, request: [u8; 8]) -> [u8; 8] {
        server.answer(&Frame::new(0x601, &request), dictionary).unwrap()
    }

    #[test]
    fn expedited_transfers_are_those_of_the_standard() {
        let (mut server, mut dictionary) = (Server::default(), dictionary());
        let mut ask = |request| ask(&mut server, &mut dictionary, request);
        // Download of two bytes: n = 2, e = 1, s = 1.
        let written = ask([0x2B, 0x17, 0x10, 0, 0xE8, 0x03, 0, 0]);
        assert_eq!(written, [0x60, 0x17, 0x10, 0, 0, 0, 0, 0]);
        let read = ask([0x40, 0x17, 0x10, 0, 0, 0, 0, 0]);
        assert_eq!(read, [0x4B, 0x17, 0x10, 0, 0xE8, 0x03, 0, 0]);
        let read = ask([0x40, 0x00, 0x10, 0, 0, 0, 0, 0]);
        assert_eq!(read, [0x43, 0x00, 0x10, 0, 0x92, 0x01, 0, 0]);
    }

    #[test]
    fn names_are_read_in_segments() {
        let (mut server, mut dictionary) = (Server::default(), dictionary());
        let mut ask = |request| ask(&mut server, &mut dictionary, request);
        let begun = ask([0x40, 0x08, 0x10, 0, 0, 0, 0, 0]);
        assert_eq!(begun, [0x41, 0x08, 0x10, 0, 15, 0, 0, 0]);
        assert_eq!(ask([0x60, 0, 0, 0, 0, 0, 0, 0]), *b"\x00simulat");
        assert_eq!(ask([0x70, 0, 0, 0, 0, 0, 0, 0]), *b"\x10ed driv");
        // One byte: six of seven unused, and the last segment.
        assert_eq!(ask([0x60, 0, 0, 0, 0, 0, 0, 0]), *b"\x0De\0\0\0\0\0\0");
    }

    #[test]
    fn refusals_carry_the_codes_of_the_standard() {
        let (mut server, mut dictionary) = (Server::default(), dictionary());
        let cases: [([u8; 8], Abort); 8] = [
            ([0x40, 0x00, 0x20, 0, 0, 0, 0, 0], Abort::NoObject),
            ([0x40, 0x17, 0x10, 1, 0, 0, 0, 0], Abort::NoSubIndex),
            ([0x23, 0x00, 0x10, 0, 0, 0, 0, 0], Abort::ReadOnly),
            ([0x23, 0x17, 0x10, 0, 0, 0, 0, 0], Abort::TooLong),
            ([0x2F, 0x17, 0x10, 0, 0, 0, 0, 0], Abort::TooShort),
            ([0x60, 0, 0, 0, 0, 0, 0, 0], Abort::Command),
            ([0xC2, 0x17, 0x10, 0, 0, 0, 0, 0], Abort::Command),
            ([0x21, 0x17, 0x10, 0, 0xFF, 0xFF, 0, 0], Abort::Memory),
        ];
        for (request, expected) in cases {
            let answer = ask(&mut server, &mut dictionary, request);
            let [command, _, _, _, code @ ..] = answer;
            assert_eq!(
                (command, u32::from_le_bytes(code)),
                (0x80, expected.code()),
                "{request:x?}"
            );
        }
    }

    #[test]
    fn a_repeated_segment_is_a_toggle_error() {
        let (mut server, mut dictionary) = (Server::default(), dictionary());
        let mut ask = |request| ask(&mut server, &mut dictionary, request);
        ask([0x40, 0x08, 0x10, 0, 0, 0, 0, 0]);
        ask([0x60, 0, 0, 0, 0, 0, 0, 0]);
        let answer = ask([0x60, 0, 0, 0, 0, 0, 0, 0]);
        assert_eq!(answer, [0x80, 0x08, 0x10, 0, 0, 0, 0x03, 0x05]);
    }

    #[test]
    fn numbers_can_be_written_in_segments() {
        let (mut server, mut dictionary) = (Server::default(), dictionary());
        let begun = ask(&mut server, &mut dictionary, [0x21, 0x17, 0x10, 0, 2, 0, 0, 0]);
        assert_eq!(begun, [0x60, 0x17, 0x10, 0, 0, 0, 0, 0]);
        let done = ask(&mut server, &mut dictionary, [0x0B, 0x34, 0x12, 0, 0, 0, 0, 0]);
        assert_eq!(done, [0x20, 0, 0, 0, 0, 0, 0, 0]);
        assert_eq!(dictionary.get(Object { index: 0x1017, sub: 0 }), 0x1234);
    }
}
