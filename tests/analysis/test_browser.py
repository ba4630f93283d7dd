"""The helper that opens pages sees what a page does wrong; else pages "without messages" would prove nothing."""

from browser import browsing, open_page

PAGE = """<!doctype html><meta charset="utf-8"><title>t</title><button style="margin: 1500px 0">press</button>
<img src="http://example.org/x.png"><script>
console.error("said", 3);
document.querySelector("button").onclick = () => { document.title = "clicked" };
addEventListener("keydown", event => { document.title += " " + event.key });
</script><script>missing.name()</script>"""


def test_errors_and_requests_are_seen(tmp_path):
    (tmp_path / "page.html").write_text(PAGE)
    messages = open_page(tmp_path / "page.html", tmp_path / "page.png")
    assert "error: said 3" in messages
    assert "network: http://example.org/x.png" in messages
    assert any("missing is not defined" in line for line in messages)
    assert (tmp_path / "page.png").read_bytes().startswith(b"\x89PNG")


def test_clicks_and_keys_arrive(tmp_path):
    (tmp_path / "page.html").write_text(PAGE)
    with browsing(tmp_path / "page.html") as page:
        page.click_on("button")
        page.press("ArrowRight")
        assert page.evaluate("document.title") == "clicked ArrowRight"
