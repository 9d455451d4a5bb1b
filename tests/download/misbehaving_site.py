"""A server on this machine that behaves as servers do when they misbehave."""

import re
import threading
from contextlib import contextmanager, suppress
from http.server import BaseHTTPRequestHandler, ThreadingHTTPServer


class Site:
    """Files by path, and what goes wrong with them.

    Attributes
    ----------
    files : path to bytes
    cut : bytes after which each answer's connection is cut; None for never
    ranges : False answers 200 and everything, whatever part was asked for
    promised : what is added to the Content-Length that is announced
    answer : function (handler) that answers instead
    requests : (path, Range header or None) of every request
    """

    def __init__(self, files: dict[str, bytes]):
        self.files = files
        self.cut: int | None = None
        self.ranges = True
        self.promised = 0
        self.failing = 0
        self.answer = None
        self.requests: list[tuple[str, str | None]] = []
        self.address = ""


@contextmanager
def serve(site: Site):
    class Handler(BaseHTTPRequestHandler):
        def do_GET(self):
            asked = self.headers.get("Range")
            site.requests.append((self.path, asked))
            if site.answer is not None:
                with suppress(OSError):
                    site.answer(self)
                return None
            if site.failing:
                site.failing -= 1
                return self.send_error(503)
            body = site.files.get(self.path)
            if body is None:
                return self.send_error(404)
            start, total = 0, len(body)
            if asked and site.ranges:
                start = int(re.fullmatch(r"bytes=(\d+)-", asked)[1])
                if start >= total:
                    return self.send_error(416)
                self.send_response(206)
                self.send_header("Content-Range", f"bytes {start}-{total - 1}/{total}")
            else:
                self.send_response(200)
            self.send_header("Content-Length", str(total - start + site.promised))
            self.end_headers()
            sent = body[start:]
            self.wfile.write(sent if site.cut is None else sent[: site.cut])

        def log_message(self, *_):
            pass

    server = ThreadingHTTPServer(("127.0.0.1", 0), Handler)
    server.daemon_threads, server.block_on_close = True, False
    thread = threading.Thread(target=server.serve_forever, kwargs={"poll_interval": 0.01})
    thread.start()
    site.address = f"http://127.0.0.1:{server.server_port}"
    try:
        yield site
    finally:
        server.shutdown()
        thread.join()
        server.server_close()
