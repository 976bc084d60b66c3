use super::to_html;

/// Opening and closing tags match; returns how many elements there are.
fn well_formed(html: &str) -> usize {
    let mut open = Vec::new();
    let mut count = 0;
    for piece in html.split('<').skip(1) {
        let tag = piece.split('>').next().unwrap();
        if let Some(name) = tag.strip_prefix('/') {
            assert_eq!(open.pop(), Some(name), "in {html}");
        } else {
            open.push(tag.split(' ').next().unwrap());
            count += 1;
        }
    }
    assert!(open.is_empty(), "{open:?} stay open in {html}");
    count
}

fn formula(inner: &str) -> String {
    to_html(&format!("\\begin{{equation}}\n{inner}\n\\end{{equation}}"))
}

#[test]
fn scripts_bind_to_their_base() {
    assert!(formula("m_b").contains("<msub><mi>m</mi><mi>b</mi></msub>"));
    let html = formula(r"\dot{\theta}_x^{2}");
    assert!(html.contains("<msubsup><mover accent=\"true\"><mrow><mi>θ</mi></mrow>"), "{html}");
    assert!(html.contains("</mover><mi>x</mi><mrow><mn>2</mn></mrow></msubsup>"), "{html}");
    assert!(formula(r"\cos^2 \phi").contains("<msup><mi>cos</mi><mn>2</mn></msup>"));
}

#[test]
fn aligned_rows_become_a_table() {
    let html =
        to_html("% Energies\n\\begin{align*}\n  T ={}& 1 \\\\\n    & \\quad {}+ 2\n\\end{align*}");
    assert!(html.starts_with("<h5>Energies</h5>"), "{html}");
    assert_eq!(html.matches("<mtr>").count(), 2);
    assert_eq!(html.matches("<mtd>").count(), 4);
    well_formed(&html);
}

#[test]
fn matrices_stand_in_brackets() {
    let html = formula(r"K = \frac{5}{7} g\begin{bmatrix}0 & 1 \\ -1 & 0\end{bmatrix}^{T}");
    assert_eq!(html.matches("<mtd>").count(), 4, "{html}");
    assert!(html.contains("<msup><mrow><mo>[</mo><mtable"), "{html}");
    assert!(html.contains("<mfrac><mrow><mn>5</mn></mrow><mrow><mn>7</mn></mrow></mfrac>"));
    well_formed(&html);
}

#[test]
fn strange_texts_are_escaped_and_balanced() {
    let deep = "{".repeat(100_000);
    let matrices = "\\begin{bmatrix}".repeat(10_000);
    let texts = [
        "<script>", "\\<b>", "}}{_^", "a^^b__c", "\\frac", "\\dot", "&&\\\\", "\\end{x}", &deep,
        &matrices,
    ];
    for text in texts {
        let html = formula(text);
        well_formed(&html);
        assert!(!html.contains("<script"), "{text}");
    }
}

#[test]
fn equations_of_every_bundled_model_are_understood() {
    for (name, text) in shapebot_models::MODELS {
        let latex = crate::tests::toolchain(name, text).0;
        let html = to_html(&latex);
        assert!(well_formed(&html) > 100, "{name}");
        assert!(!html.contains("<mtext>"), "{name}: {}", html.split("<mtext>").nth(1).unwrap());
    }
}
