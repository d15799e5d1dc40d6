# The studio and every command that needs no training, from the wheel in dist/:
#
#     make release   (or: python -m build), then
#     docker build -t normalgan .
#     docker run --rm -p 127.0.0.1:8400:8400 -v normalgan:/home/normalgan normalgan
#     docker run --rm --user "$(id -u)" -v "$PWD:/work" normalgan generate drawing.png -o drawing_normal.png
#
# Publish the port on 127.0.0.1 only: the studio has no password.
FROM python:3.12-slim
RUN useradd --create-home normalgan
COPY dist/normalgan-*.whl /tmp/
RUN pip install --no-cache-dir /tmp/normalgan-*.whl && rm /tmp/normalgan-*.whl
USER normalgan
WORKDIR /work
EXPOSE 8400
ENTRYPOINT ["normalgan"]
# The port that is published leads to the container's own address, not to its 127.0.0.1.
CMD ["studio", "--no-browser", "--address", "0.0.0.0"]
