//! The LaTeX that the generator prints, as MathML.
//!
//! Understood is what `shapebot_codegen::equations::to_latex` writes: `equation` and `align*` with
//! `bmatrix`, fractions, dots, sub- and superscripts, Greek letters and function names. Comments become
//! headings. An unknown command is shown by its name; no input panics.

mod token;

use std::fmt::Write as _;
use token::{Token, tokens};

/// Deepest nesting of groups; what is deeper is left out.
const DEPTH: usize = 64;

/// HTML with MathML for a LaTeX fragment. All of its text is escaped.
pub(crate) fn to_html(fragment: &str) -> String {
    let mut html = String::new();
    let mut block = String::new();
    for line in fragment.lines() {
        let line = line.trim();
        if let Some(comment) = line.strip_prefix('%') {
            heading(&mut html, comment.trim());
        } else if let Some(name) = environment(line, "\\begin{") {
            block.clear();
            // A matrix that begins a line is no environment of its own.
            if name == "bmatrix" {
                block.push_str(line);
            }
        } else if environment(line, "\\end{").is_some() {
            display(&mut html, &block);
            block.clear();
        } else {
            block.push_str(line);
            block.push('\n');
        }
    }
    html
}

fn environment<'a>(line: &'a str, opening: &str) -> Option<&'a str> {
    line.strip_prefix(opening)?.strip_suffix('}')
}

fn heading(html: &mut String, text: &str) {
    // The first line says which packages the fragment needs.
    if !text.contains("\\usepackage") {
        let _ = writeln!(html, "<h5>{}</h5>", crate::text::escape(text));
    }
}

/// Rows of an aligned display.
fn display(html: &mut String, block: &str) {
    let mut reader = Reader { tokens: tokens(block), at: 0, depth: 0 };
    let mut rows = vec![vec![String::new()]];
    while let Some(token) = reader.peek() {
        match token {
            Token::NewRow => {
                reader.at += 1;
                rows.push(vec![String::new()]);
            }
            Token::NewCell => {
                reader.at += 1;
                if let Some(row) = rows.last_mut() {
                    row.push(String::new());
                }
            }
            _ => {
                let item = reader.item();
                if let Some(cell) = rows.last_mut().and_then(|row| row.last_mut()) {
                    cell.push_str(&item);
                }
            }
        }
    }
    rows.retain(|row| row.iter().any(|cell| !cell.is_empty()));
    html.push_str("<div class=\"formula\"><math displaystyle=\"true\">");
    if let [row] = rows.as_slice() {
        let _ = write!(html, "<mrow>{}</mrow>", row.concat());
    } else {
        table(html, &rows, "aligned");
    }
    html.push_str("</math></div>\n");
}

fn table(html: &mut String, rows: &[Vec<String>], class: &str) {
    let _ = write!(html, "<mtable class=\"{class}\" displaystyle=\"{}\">", class == "aligned");
    for row in rows {
        html.push_str("<mtr>");
        for cell in row {
            let _ = write!(html, "<mtd><mrow>{cell}</mrow></mtd>");
        }
        html.push_str("</mtr>");
    }
    html.push_str("</mtable>");
}

struct Reader {
    tokens: Vec<Token>,
    at: usize,
    depth: usize,
}

impl Reader {
    fn peek(&self) -> Option<&Token> {
        self.tokens.get(self.at)
    }

    fn next(&mut self) -> Option<Token> {
        let token = self.tokens.get(self.at).cloned();
        self.at += 1;
        token
    }

    /// One symbol with its sub- and superscript.
    fn item(&mut self) -> String {
        let base = self.base();
        let (mut below, mut above) = (None, None);
        loop {
            match self.peek() {
                Some(Token::Sub) if below.is_none() => {
                    self.at += 1;
                    below = Some(self.base());
                }
                Some(Token::Sup) if above.is_none() => {
                    self.at += 1;
                    above = Some(self.base());
                }
                _ => break,
            }
        }
        match (below, above) {
            (None, None) => base,
            (Some(b), None) => format!("<msub>{base}{}</msub>", script(b)),
            (None, Some(a)) => format!("<msup>{base}{}</msup>", script(a)),
            (Some(b), Some(a)) => format!("<msubsup>{base}{}{}</msubsup>", script(b), script(a)),
        }
    }

    /// One symbol, group or command with its arguments: exactly one MathML element, or nothing at the end.
    fn base(&mut self) -> String {
        match self.next() {
            None => String::new(),
            Some(Token::Open) => self.group(),
            Some(Token::Letter(c)) => format!("<mi>{}</mi>", escape(c)),
            Some(Token::Number(text)) => format!("<mn>{text}</mn>"),
            Some(Token::Sign(c)) => sign(c),
            Some(Token::Command(name)) => self.command(&name),
            // Out of place: nothing to show.
            Some(Token::Close | Token::Sub | Token::Sup | Token::NewRow | Token::NewCell) => {
                "<mrow></mrow>".to_owned()
            }
        }
    }

    /// Up to the closing brace.
    fn group(&mut self) -> String {
        self.until(|token| *token == Token::Close)
    }

    fn until(&mut self, is_end: impl Fn(&Token) -> bool) -> String {
        let mut inner = String::new();
        self.depth += 1;
        while let Some(token) = self.peek() {
            if is_end(token) {
                self.at += 1;
                break;
            }
            if self.depth > DEPTH {
                self.at += 1;
            } else {
                inner.push_str(&self.item());
            }
        }
        self.depth -= 1;
        format!("<mrow>{inner}</mrow>")
    }

    fn command(&mut self, name: &str) -> String {
        if let Some(letter) = token::letter(name) {
            return format!("<mi>{letter}</mi>");
        }
        match name {
            "sin" | "cos" | "tan" | "exp" | "ln" | "log" | "sqrt" | "arctan" | "arcsin"
            | "arccos" | "sinh" | "cosh" | "tanh" => self.function(name),
            "frac" => {
                let (above, below) = (self.base(), self.base());
                format!("<mfrac>{above}{below}</mfrac>")
            }
            "dot" => self.accent("˙"),
            "ddot" => self.accent("¨"),
            "left" | "right" => self.base(),
            "begin" => self.matrix(),
            "end" => {
                self.base();
                String::new()
            }
            "," => space("0.17em"),
            ";" => space("0.28em"),
            "quad" => space("1em"),
            "qquad" => space("2em"),
            "cdot" => "<mo>⋅</mo>".to_owned(),
            other => {
                let shown: String = other.chars().map(escape).collect();
                format!("<mtext>\\{shown}</mtext>")
            }
        }
    }

    fn function(&mut self, name: &str) -> String {
        if name == "sqrt" {
            return format!("<msqrt>{}</msqrt>", self.base());
        }
        let mut head = format!("<mi>{name}</mi>");
        if self.peek() == Some(&Token::Sup) {
            self.at += 1;
            head = format!("<msup>{head}{}</msup>", script(self.base()));
        }
        // The thin gap that is set around a function's name.
        format!("<mrow>{head}{}</mrow>", space("0.12em"))
    }

    fn accent(&mut self, mark: &str) -> String {
        format!("<mover accent=\"true\">{}<mo stretchy=\"false\">{mark}</mo></mover>", self.base())
    }

    /// After `\begin`: a matrix in brackets.
    fn matrix(&mut self) -> String {
        self.base();
        let mut rows = vec![vec![String::new()]];
        self.depth += 1;
        while let Some(token) = self.peek() {
            match token {
                Token::Command(name) if name == "end" => {
                    self.at += 1;
                    self.base();
                    break;
                }
                Token::NewRow => {
                    self.at += 1;
                    rows.push(vec![String::new()]);
                }
                Token::NewCell => {
                    self.at += 1;
                    if let Some(row) = rows.last_mut() {
                        row.push(String::new());
                    }
                }
                _ if self.depth > DEPTH => self.at += 1,
                _ => {
                    let item = self.item();
                    if let Some(cell) = rows.last_mut().and_then(|row| row.last_mut()) {
                        cell.push_str(&item);
                    }
                }
            }
        }
        self.depth -= 1;
        let mut html = "<mrow><mo>[</mo>".to_owned();
        table(&mut html, &rows, "matrix");
        html.push_str("<mo>]</mo></mrow>");
        html
    }
}

/// A script must be one element.
fn script(inner: String) -> String {
    if inner.is_empty() { "<mrow></mrow>".to_owned() } else { inner }
}

fn space(width: &str) -> String {
    format!("<mspace width=\"{width}\"></mspace>")
}

fn sign(c: char) -> String {
    match c {
        '-' => "<mo>−</mo>".to_owned(),
        '(' | ')' | '[' | ']' => format!("<mo stretchy=\"false\">{c}</mo>"),
        '*' => "<mo>⋅</mo>".to_owned(),
        other => format!("<mo>{}</mo>", escape(other)),
    }
}

fn escape(c: char) -> String {
    crate::text::escape(c.encode_utf8(&mut [0; 4]))
}

#[cfg(test)]
mod tests;
